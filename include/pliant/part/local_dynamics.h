// The dynamics of a part whose nodes deform locally, in its body frame (design 1.3). With all forces F on the
// nodes, those F_d of them that act on d alone, and what acts on (c, theta, q_s) beside the nodes,
//   K kappa = sum G^T F_d - f_r,            K = H - P^T,  H = sum G^T W,  P = d(W^T d)/dq_s
//   m y = F - W kappa
//   K^T a_r = sum W^T y + 2 sum Wdot^T ddot + sum Wddot^T d
//   d_ddot = y - G a_r
// with G = [I, -[p]x, J], p = s + d, and W = m G at d = 0. No matrix of mesh size is formed.
#pragma once

#include <vector>

#include <Eigen/LU>

#include <pliant/math/thread_pool.h>
#include <pliant/part/local_deformation.h>
#include <pliant/part/part.h>

namespace pliant {

/// What is recomputed at each evaluation, in the order of the stages.
struct LocalWorkspace {
  // positions
  VecX<double> d, d_dot;  ///< local coordinates
  VecX<double> x;         ///< positions p = s + d of the nodes, then the energies' own coordinates
  Nodes s, u;             ///< reference shape; velocity J q_s_dot + d_dot
  MatX<double> J;         ///< of all nodes along x, y, z of the first parameter, then of the second
  Nodes s1, s2;           ///< J q_s_dot, Jdot q_s_dot
  // mass
  MatX<double> H0;
  VecMax<double> scale;                        ///< of K: the diagonal of H0 becomes 1
  Eigen::PartialPivLU<MatMax<double>> factor;  ///< of scale K scale
  Vec3<double> moment;                         ///< sum m p
  VecMax<double> rates;                        ///< 2 Wdot^T d_dot + Wddot^T d
  double condition = 1;                        ///< of K, scaled
  // forces, N
  VecX<double> x_dot;            ///< rates of x in the body frame, where they damp
  VecX<double> f, f_d;           ///< on all that nodes do; on d alone, the rest being told in f_r
  VecX<double> force;            ///< sum of both
  double damping = 0, drag = 0;  ///< their powers, W
  VecMax<double> kappa;
  VecX<double> d_ddot;
  VecX<double> a_free;  ///< (a_r, d_ddot at the shared points) without joints and limits
  // what pushes on v_r and on the shared points do, see local_compliance()
  MatX<double> kappa_of, a_of, A, A_inverse;
  std::vector<NodalEnergy::Buffer> buffers;

  /// K^-1 b and K^-T b.
  template <class B>
  MatX<double> solve(const B& b) const {
    const MatX<double> scaled = factor.solve(MatX<double>(scale.asDiagonal() * b));
    return scale.asDiagonal() * scaled;
  }
  template <class B>
  MatX<double> solve_transposed(const B& b) const {
    const MatX<double> scaled = factor.transpose().solve(MatX<double>(scale.asDiagonal() * b));
    return scale.asDiagonal() * scaled;
  }
};

/// positions: s, J, p and u at the nodes.
void local_positions(const Part& part, const LocalDeformation& local, const VecX<double>& q_s,
                     const VecX<double>& q_s_dot, LocalWorkspace& w, Counters& counters);
/// mass: H, P, K and its factor.
void local_masses(const Part& part, const LocalDeformation& local, const VecX<double>& q_s,
                  const VecX<double>& q_s_dot, LocalWorkspace& w, Counters& counters);
/// forces on the nodes: inertial, gravity g (body frame), drag nu; those of the energies, and their damping.
void local_forces(const LocalDeformation& local, const VecX<double>& v_r, const Vec3<double>& g, double nu,
                  LocalWorkspace& w, ThreadPool* pool);
/// Adds a force on a material point, body frame; what it does to (c, theta, q_s) is told apart.
void push_nodes(const LocalDeformation& local, const NodeWeights& at, const Vec3<double>& force,
                LocalWorkspace& w);
/// accelerations. f_r: what acts on (c, theta, q_s) beside the nodes' own forces; becomes a_r.
void local_accelerations(const LocalDeformation& local, VecX<double>& f_r, LocalWorkspace& w);

/// A = M^-1 as the joints of a part see it: what pushes g on (v_r, the points) do to (v_r, d_dot at the
/// points), and its inverse where no points hold each other.
void local_compliance(const LocalDeformation& local, const std::vector<NodeWeights>& points,
                      LocalWorkspace& w);
/// Adds to local velocities what such pushes do to all nodes.
void push_all_nodes(const LocalDeformation& local, const std::vector<NodeWeights>& points,
                    const VecX<double>& g, const LocalWorkspace& w, Eigen::Ref<VecX<double>> d_dot);
/// Values of nodes at points.
VecX<double> at_points(const std::vector<NodeWeights>& points, const Eigen::Ref<const Nodes>& values);

/// M of rigid motion at the positions of the nodes, body frame: 6 x 6.
Eigen::Matrix<double, 6, 6> local_inertia(const LocalDeformation& local, const LocalWorkspace& w);

/// sum W^T a over nodes.
VecMax<double> frame_share(const LocalDeformation& local, const Nodes& a, const LocalWorkspace& w);
/// G v_r of all nodes; and their velocities G v_r + d_dot, v_r having J q_s_dot in it.
Nodes frame_velocities(const LocalDeformation& local, const VecMax<double>& v_r, const LocalWorkspace& w);
Nodes node_velocities(const LocalDeformation& local, const VecMax<double>& v_r, const LocalWorkspace& w);

/// Energy of the nodes' motion and of their elasticity, J; momentum and angular momentum about the frame's
/// origin, body frame; first moment sum m p.
struct LocalMotion {
  double kinetic, elastic;
  Vec3<double> momentum, angular_momentum, moment;
};
LocalMotion local_motion(const LocalDeformation& local, const VecX<double>& v_r, const LocalWorkspace& w);

}  // namespace pliant
