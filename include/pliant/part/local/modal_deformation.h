// Local deformation by n modes, Eq. (5). q_d are the amplitudes of the modes; each mode is an oscillator. The
// modes are orthogonal to rigid motion and to the fields J of the dynamic parameters at the rest shape.
// Therefore the reference conditions of the rest shape hold for every q_d. Let p_a = s_a + d_a, J_a and e_a
// be the coefficients of p, of J and of the constant 1 for the field phi_a of the basis (modal_basis.h), m_a
// the mass of this field, B_a the rows of B for a, and G_a = [e_a I, -[p_a]x, J_a]. Then
//   M = [M_rr, C; C^T, I],   C = sum m_a G_a^T B_a,   M_rr = sum m_a G_a^T G_a
//   S a_r = f_r - C f_d,   S = M_rr - C C^T,   q_d_ddot = f_d - C^T a_r
// f_r and f_d are the forces on (c, theta, q_s) and on q_d. S is a Schur complement, not the shape matrix of
// Eq. (5). The current reference shape s is not in the span of the fields phi_a. Integrals of s alone are
// therefore sums over the mass points of the part (part/inertia.h).
#pragma once

#include <Eigen/LU>

#include <pliant/part/local/modal_basis.h>
#include <pliant/part/part.h>

namespace pliant {

struct ModalWorkspace final : LocalWorkspace {
  // Stage positions(), at the spectral nodes.
  Nodes D, D_dot;          ///< d and d_dot
  MatX<double> shape;      ///< blocks N x 3: s, J q_s_dot, Jdot q_s_dot, and ds/dq_k of each parameter q_k
  MatX<double> at_points;  ///< the same blocks at the points of the basis
  static constexpr Eigen::Index kS = 0, kS1 = 3, kS2 = 6, kJ = 9;  ///< first columns of the blocks
  auto s() const { return shape.middleCols<3>(kS); }
  auto s1() const { return shape.middleCols<3>(kS1); }
  auto s2() const { return shape.middleCols<3>(kS2); }
  auto J(Eigen::Index k) const { return shape.middleCols<3>(kJ + 3 * k); }
  // Stage masses().
  Inertia<double> undeformed;  ///< inertia of the part at d = 0
  MatX<double> R;              ///< R^T B gives the rows of C for theta and q_s; the rows for c are zero
  MatX<double> M_rr, C;        ///< C: (6 + n_s) x n
  VecMax<double> scale;        ///< factors that scale the diagonal of M at d = 0 to 1
  Eigen::PartialPivLU<MatMax<double>> factor;  ///< factorisation of scale S scale
  // Stage forces().
  Nodes F;           ///< forces on the spectral nodes: inertial forces -m b and the forces of push(), N
  VecX<double> f_r;  ///< forces of inertia, gravity and drag on (c, theta, q_s), body frame
  VecX<double> f_d;  ///< forces of elasticity, damping and drag on the amplitudes
  // Joints.
  MatX<double> P, C_P;  ///< P: modes at the attachment points. C_P: C P^T

  double condition() const override;
  /// Returns S^-1 b.
  template <class Rhs>
  MatX<double> solve(const Rhs& b) const {
    const MatX<double> scaled = factor.solve(MatX<double>(scale.asDiagonal() * b));
    return scale.asDiagonal() * scaled;
  }
};

class ModalDeformation final : public LocalDeformation {
 public:
  /// Uses the damping and the initial values of the settings. Throws std::invalid_argument if an initial
  /// displacement is larger than Part::size() or an initial velocity is not finite.
  ModalDeformation(const Part& part, const LocalSettings& settings, ModalBasis basis);

  const ModalBasis& basis() const { return basis_; }
  Eigen::Index n_modes() const { return basis_.B.cols(); }

  std::string coordinate_name(Eigen::Index k) const override;
  const char* unit(Eigen::Index k) const override;
  double cost() const override;
  std::string description() const override;
  NodeWeights weights(const Part& part, const Material<double>& m) const override;
  Eigen::Map<const Nodes> at_nodes(const double* q_d, VecX<double>& buffer) const override;
  Nodes displacements(const double* q_d) const override;
  Eigen::Matrix3Xd displacements(const double* q_d, const std::vector<int>& nodes) const override;
  const ModalDeformation* modal() const override { return this; }
  const Oscillators* oscillators() const override { return &oscillators_; }
  /// Returns the oscillators with a factor of the laws (PartDescription::scale_local).
  Oscillators oscillators_at(double factor) const;

  std::unique_ptr<LocalWorkspace> workspace() const override;
  void positions(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r, LocalWorkspace& work,
                 Counters& counters) const override;
  void masses(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r, LocalWorkspace& work,
              Counters& counters) const override;
  void forces(const VecX<double>& v_r, const Vec3<double>& g, double nu, LocalWorkspace& work,
              ThreadPool* pool) const override;
  void push(const NodeWeights& at, const Vec3<double>& force, LocalWorkspace& work) const override;
  void accelerations(VecX<double>& f_r, LocalWorkspace& work, Eigen::Ref<VecX<double>> d_ddot) const override;
  Eigen::Matrix<double, 6, 6> rigid_inertia(const LocalWorkspace& work) const override;
  LocalMotion motion(const VecX<double>& v_r, const LocalWorkspace& work) const override;
  Bound stiffness_bound(const LocalWorkspace& work) const override;
  double mobility(const NodeWeights& at) const override;

  /// Returns the displacements of a node of mesh() for unit amplitudes of the modes: 3 x n.
  Eigen::Matrix3Xd modes_of_node(int node) const;
  /// Replaces impulses on v_r (on_frame) and on the modes (on_modes) by the changes of v_r and q_d_dot that
  /// these impulses cause. masses() must have run on the workspace.
  void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_modes, const LocalWorkspace& work) const;

 private:
  /// Computes f_d of the workspace and the power of the damping by these oscillators.
  static void set_oscillator_forces(const Oscillators& oscillators, ModalWorkspace& w);
  MatX<double> inertial_compliance(const std::vector<NodeWeights>& points,
                                   LocalWorkspace& work) const override;
  void inertial_push_all(const std::vector<NodeWeights>& points, const VecX<double>& g,
                         const LocalWorkspace& work, Eigen::Ref<VecX<double>> d_dot) const override;
  /// Casts the workspace that workspace() made.
  static ModalWorkspace& of(LocalWorkspace& work) { return static_cast<ModalWorkspace&>(work); }
  static const ModalWorkspace& of(const LocalWorkspace& work) {
    return static_cast<const ModalWorkspace&>(work);
  }
  /// Number of spectral nodes.
  Eigen::Index n_fields() const { return basis_.mass.size(); }
  /// Returns the displacements of a material point for unit amplitudes of the modes: 3 x n.
  MatX<double> modes_at(const NodeWeights& at) const;
  /// Computes w.shape: evaluates the reference shape at the points of the basis and projects the values.
  void project_shape(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r, ModalWorkspace& w,
                     Counters& counters) const;

  ModalBasis basis_;
  Oscillators oscillators_;
  std::vector<Material<Pack>> packs_;  // the points of the basis; empty if no parameter is dynamic
};

}  // namespace pliant
