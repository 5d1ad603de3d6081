// Local deformation by modes, q_d = their amplitudes, which are oscillators: orthogonal to rigid motion and
// to the fields J of the dynamic parameters at the rest shape, so that reference conditions hold by
// themselves. With p_a = s_a + d_a of the spectral nodes (modal_basis.h), G_a = [e_a I, -[p_a]x, J_a],
//   M = [M_rr, C; C^T, I],   C = sum m_a G_a^T B_a,   M_rr = sum m_a G_a^T G_a
//   S a_r = f_r - C f_d,   S = M_rr - C C^T,   q_d_ddot = f_d - C^T a_r
// Integrals of the reference shape alone, which is no sum of phi, are those of the part (part/inertia.h).
#pragma once

#include <Eigen/LU>

#include <pliant/local/solid/four_nodes.h>

#include <pliant/part/local/modal_basis.h>
#include <pliant/part/part.h>

namespace pliant {

struct ModalWorkspace final : LocalWorkspace {
  // positions, of spectral nodes
  Nodes D, D_dot;
  MatX<double> shape;      ///< N x 3 each: reference shape s, J q_s_dot, Jdot q_s_dot, J of each parameter
  MatX<double> at_points;  ///< the same at the points of the basis
  // mass
  Inertia<double> still;                       ///< of the part at d = 0
  MatX<double> R;                              ///< C = R^T B
  MatX<double> M_rr, C;                        ///< C: (6 + n_s) x n
  VecMax<double> scale;                        ///< of S: the diagonal of M at d = 0 becomes 1
  Eigen::PartialPivLU<MatMax<double>> factor;  ///< of scale S scale
  // forces
  Nodes F;           ///< on the spectral nodes, N
  VecX<double> own;  ///< what inertia, gravity and drag do to (c, theta, q_s)
  VecX<double> f_d;  ///< what elasticity, damping and drag do to the modes
  // what pushes on v_r and on the shared points do
  MatX<double> P, C_P;  ///< modes at the points; C P^T

  double condition() const override;
  template <class Rhs>
  MatX<double> solve(const Rhs& b) const {
    const MatX<double> scaled = factor.solve(MatX<double>(scale.asDiagonal() * b));
    return scale.asDiagonal() * scaled;
  }
};

class ModalDeformation final : public LocalDeformation {
 public:
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

  /// What the modes move a node of mesh() by: 3 x n.
  Eigen::Matrix3Xd modes_of_node(int node) const;
  /// Pushes on v_r and on the modes become what they change the rates by. work: with its masses.
  void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_modes, const LocalWorkspace& work) const;

 private:
  MatX<double> own_compliance(const std::vector<NodeWeights>& points, LocalWorkspace& work) const override;
  void own_push_all(const std::vector<NodeWeights>& points, const VecX<double>& g, const LocalWorkspace& work,
                    Eigen::Ref<VecX<double>> d_dot) const override;
  static ModalWorkspace& of(LocalWorkspace& work) { return static_cast<ModalWorkspace&>(work); }
  static const ModalWorkspace& of(const LocalWorkspace& work) {
    return static_cast<const ModalWorkspace&>(work);
  }
  Eigen::Index n_fields() const { return basis_.mass.size(); }
  /// Modes at a point: 3 x n.
  MatX<double> modes_at(const NodeWeights& at) const;
  /// The shape of the spectral nodes.
  void project_shape(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r, ModalWorkspace& w,
                     Counters& counters) const;

  ModalBasis basis_;
  Oscillators oscillators_;
  std::vector<Material<Pack>> packs_;  ///< of the points of the basis, when the shape moves
};

}  // namespace pliant
