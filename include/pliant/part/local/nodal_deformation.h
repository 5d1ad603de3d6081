// Local deformation at the nodes of a mesh, Eqs. (5) and (6): q_d consists of the displacements d of the
// nodes, in the body frame, and of the own coordinates of an energy if there are any (local/nodal_energy.h).
// The reference conditions are those of mean axes at the current shape (include/pliant/part/local/README.md):
//   W^T d = 0,   W_k = m_k G0_k(q_s),   G0 = [I, -[s]x, J]
// Let F be all forces on the nodes, F_d the forces among them that act on d alone, and f the generalised
// forces on (c, theta, q_s) that are not forces on nodes. Then
//   K kappa = sum G^T F_d - f,              K = H - P^T,  H = sum G^T W,  P = d(W^T d)/dq_s
//   m y = F - W kappa
//   K^T a_r = sum W^T y + 2 sum Wdot^T d_dot + sum Wddot^T d
//   d_ddot = y - G a_r
// with G = [I, -[p]x, J], p = s + d and the multipliers kappa of the conditions. The sums are over nodes, m
// is the mass of a node, and the columns of P for c and theta are zero. No matrix of mesh size is formed.
// nodal_masses-inl.h and nodal_forces-inl.h have the stages, nodal_frame-inl.h has the conditions.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include <Eigen/LU>

#include <pliant/part/local/local_deformation.h>
#include <pliant/part/part.h>

namespace pliant {

struct NodalWorkspace final : LocalWorkspace {
  // Stage positions().
  VecX<double> x;      ///< p = s + d of the nodes, then the own coordinates of an energy
  Nodes s;             ///< reference shape
  Nodes u;             ///< J q_s_dot + d_dot; empty if no parameter is dynamic, see rates_of_p()
  MatX<double> J;      ///< ds/dq_s, 3N x n_s; rows: x of all N nodes, then y, then z
  Nodes s1, s2;        ///< J q_s_dot and Jdot q_s_dot. Empty if n_s = 0; s2 also if s is linear in q_s
  Vec3<double> m_d;    ///< sum m d
  Mat3<double> m_d_s;  ///< sum m d s^T
  // Stage masses().
  VecMax<double> violation;  ///< W^T d; zero if the reference conditions hold
  VecMax<double> scale;      ///< factors that scale the diagonal of H0 to 1
  /// Factorisation of the matrix scale K scale; of fixed size 6 x 6 if no parameter is dynamic.
  std::variant<Eigen::PartialPivLU<Eigen::Matrix<double, 6, 6>>, Eigen::PartialPivLU<MatMax<double>>> factor;
  VecMax<double> rates;  ///< 2 Wdot^T d_dot + Wddot^T d
  // Stage forces(). Forces are in N.
  VecX<double> x_dot;  ///< rates of x in the body frame, for damping
  /// f: forces of the energies that depend on p. f_d: F_d, which are the forces of the energies that depend
  /// on d, and the damping by alpha. Both include the damping by beta.
  VecX<double> f, f_d;
  /// sum G^T F_d, plus G^T times each force of push(). The caller also adds these products to f_r of
  /// accelerations(), so that they cancel in frame_force_d - f_r.
  VecMax<double> frame_force_d;
  VecMax<double> frame_force_all;  ///< sum G0^T F of all forces F
  // Stage accelerations().
  VecMax<double> kappa;  ///< multipliers of the reference conditions
  // Joints: kappa and the change of v_r by unit impulses on v_r and on the attachment points, one impulse for
  // each column.
  MatX<double> kappa_response, a_response;
  // Scratch storage.
  std::vector<NodalEnergy::Buffer> buffers;
  /// Storage of project_frames() (project/project.h): positions and velocities of the nodes.
  Nodes p_kept, u_kept;

  /// Returns J q_s_dot + d_dot of n nodes: x of all nodes, then y, then z.
  const double* rates_of_p(Eigen::Index n) const { return u.rows() == n ? u.data() : d_dot.data(); }
  double condition() const override;
  /// Returns K^-1 b.
  template <class B>
  auto solve(const B& b) const {
    Solution<B> y = scale.asDiagonal() * b;
    std::visit([&](const auto& lu) { y = lu.solve(y).eval(); }, factor);
    return Solution<B>(scale.asDiagonal() * y);
  }
  /// Returns K^-T b.
  template <class B>
  auto solve_transposed(const B& b) const {
    Solution<B> y = scale.asDiagonal() * b;
    std::visit([&](const auto& lu) { y = lu.transpose().solve(y).eval(); }, factor);
    return Solution<B>(scale.asDiagonal() * y);
  }

 private:
  template <class B>
  using Solution = std::conditional_t<B::ColsAtCompileTime == 1, VecMax<double>, MatX<double>>;
};

class NodalDeformation final : public LocalDeformation {
 public:
  /// Throws std::invalid_argument if the mesh or an energy cannot be made, if an initial displacement is
  /// larger than Part::size(), or if an initial velocity is not finite.
  NodalDeformation(const Part& part, const LocalSettings& settings);

  Eigen::Index n_nodes() const { return mesh().X.rows(); }
  /// Diagonal of the mass matrix of the local coordinates: the masses of all nodes along x, then y, then z,
  /// then the inertia of the own coordinates of an energy.
  const VecX<double>& inertia() const { return inertia_; }
  /// 1 / inertia() of each coordinate.
  const VecX<double>& mobility() const { return mobility_; }
  /// The nodes in packs of four.
  const std::vector<Material<Pack>>& packs() const { return packs_; }
  const std::vector<std::unique_ptr<NodalEnergy>>& energies() const { return energies_; }
  /// Whether all energies are quadratic in d, so that their stiffness is constant.
  bool stiffness_is_constant() const;

  std::string coordinate_name(Eigen::Index k) const override;
  const char* unit(Eigen::Index k) const override;
  double cost() const override;
  std::string description() const override;
  NodeWeights weights(const Part& part, const Material<double>& m) const override;
  Eigen::Map<const Nodes> at_nodes(const double* q_d, VecX<double>& buffer) const override;
  Nodes displacements(const double* q_d) const override;
  Eigen::Matrix3Xd displacements(const double* q_d, const std::vector<int>& nodes) const override;
  const NodalDeformation* nodal() const override { return this; }

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

  /// Casts the workspace that workspace() made.
  static NodalWorkspace& of(LocalWorkspace& work) { return static_cast<NodalWorkspace&>(work); }
  static const NodalWorkspace& of(const LocalWorkspace& work) {
    return static_cast<const NodalWorkspace&>(work);
  }
  /// The violation of the six reference conditions of rigid motion.
  struct ConditionViolation {
    Vec<double, 6> W_d, W_d_dot;  ///< W^T d, W^T d_dot
    Mat3<double> d_s;             ///< sum m d s^T
  };
  /// Returns the violation of the conditions by displacements d and rates d_dot.
  ConditionViolation violation(const Eigen::Ref<const Nodes>& d, const Eigen::Ref<const Nodes>& d_dot,
                               const LocalWorkspace& work) const;
  /// Returns sum W^T a over nodes, 6 + n_s numbers. a: one row for each node.
  VecMax<double> frame_share(const Eigen::Ref<const Nodes>& a, const LocalWorkspace& work) const;
  /// Computes to = from + sign G v_r of all nodes. The arrays `from` and `to` have the layout of local
  /// coordinates and may be the same array.
  void add_frame_velocities(const VecMax<double>& v_r, double sign, const LocalWorkspace& work,
                            const double* from, double* to) const;
  /// Transforms positions p and velocities u of all nodes from the current frame to a new frame:
  /// p <- turn^T (p - shift), u <- turn^T u. shift (m) is the origin of the new frame and turn its
  /// orientation, both with components in the current frame.
  void move_frame(const Vec3<double>& shift, const Mat3<double>& turn, Nodes& p, Nodes& u) const;

 private:
  MatX<double> inertial_compliance(const std::vector<NodeWeights>& points,
                                   LocalWorkspace& work) const override;
  void inertial_push_all(const std::vector<NodeWeights>& points, const VecX<double>& g,
                         const LocalWorkspace& work, Eigen::Ref<VecX<double>> d_dot) const override;
  /// Computes s, J, s1 and u of the workspace if s is linear in q_s.
  void linear_positions(const VecX<double>& q_s, const VecMax<double>& q_s_dot, NodalWorkspace& w) const;
  /// Computes f and f_d of the workspace: the elastic forces and their damping.
  void add_elasticity(NodalWorkspace& w, ThreadPool* pool) const;
  /// Multiplies f, f_d and the power of the damping by the factor of the laws.
  void scale_elasticity(NodalWorkspace& w) const;
  /// Returns the energy of the laws without their factor, J.
  double elastic_energy(const NodalWorkspace& w) const;
  /// Adds beta times the viscous forces of the energies to f and f_d.
  void add_viscous_forces(NodalWorkspace& w, ThreadPool* pool) const;

  /// The constants if s is linear in q_s: s = s_0 + J q_s at the nodes, and the inertia at d = 0.
  struct Linear {
    Nodes s_0;
    MatX<double> J;
    LinearInertia inertia;
  };
  Linear make_linear(const Part& part) const;

  std::vector<Material<Pack>> packs_;
  std::optional<Linear> linear_;
  VecX<double> inertia_, mobility_;
  std::vector<std::unique_ptr<NodalEnergy>> energies_;
  bool of_positions_ = false;  // whether an energy depends on positions p
  std::string laws_;           // names of the laws
};

}  // namespace pliant
