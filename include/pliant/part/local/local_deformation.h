// The local deformation of a part, d = S q_d: displacements of its material points in the part's frame, by
// local coordinates q_d. Rigid motion and changes of the global parameters could be written in d as well;
// reference conditions W^T d = 0 take that out (design 1.3). This is the face of every choice of S; one call
// handles a whole part:
//   nodal_deformation.h   d at the nodes of a mesh
//   modal_deformation.h   d = sum Phi_j q_j of global modes
// Material points see d through nodes: d = sum weight_i d_i, d_i the values that at_nodes() makes of q_d.
#pragma once

#include <bitset>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/math/sparse_factor.h>
#include <pliant/math/thread_pool.h>
#include <pliant/part/local/local_mesh.h>

namespace pliant {

class ModalDeformation;
class NodalDeformation;
class Part;
struct Counters;

/// An energy that is to be laid (part/local_laws.h has those that scenes know).
struct LocalLaw {
  using Lay = std::function<std::unique_ptr<NodalEnergy>(const LocalMesh&)>;
  template <class F, class = std::enable_if_t<std::is_constructible_v<Lay, F>>>
  LocalLaw(F on_mesh, std::string its_name = "of one's own", std::optional<Elasticity> of_solid = {})
      : lay(std::move(on_mesh)), name(std::move(its_name)), linear(of_solid) {}

  Lay lay;  ///< on a mesh
  std::string name;
  std::optional<Elasticity> linear;  ///< of linear elasticity of a solid, which needs no mesh
};

/// A local deformation that cannot be.
struct LocalFault : std::invalid_argument {
  LocalFault(const std::string& what, int of_law = -1) : std::invalid_argument(what), law(of_law) {}
  int law;  ///< number among the energies of the one at fault; -1: it is not that of one
};

/// How a part is to deform locally.
struct LocalSettings {
  /// What S is made of: displacements of the nodes of a mesh; displacement polynomials over the body of a
  /// solid; the lowest modes of a mesh.
  enum class Basis { nodes, polynomial, modes };
  Basis basis = Basis::nodes;
  int degree = 4;      ///< of the polynomials, 1 to 10
  int modes = 20;      ///< how many
  int resolution = 8;  ///< edges along an eighth of a great circle, see Surface and Solid
  int order = 1;       ///< of the elements of a solid: 1 straight, 4 nodes; 2 curved, 15 nodes (of modes 10)
  using Law = LocalLaw;
  std::vector<Law> energies;
  /// At time 0, from the place of a point at rest (body frame, m): m and m/s; none: zero.
  std::function<Vec3<double>(const Vec3<double>&)> displacement, velocity;
  double alpha = 0, beta = 0;  ///< D = alpha M + beta K of the local coordinates, 1/s and s
  /// Of the stiffness of a mesh whose modes are to be found; from some ten thousand coordinates on CHOLMOD's
  /// is many times faster (solve/cholmod_factor.h).
  MakeSparseFactor make_factor = make_eigen_factor;
};

/// What pushes on (v_r, the points at joints) do to a part in place of M^-1: of a method that steps its
/// elasticity implicitly, over a step.
class LocalResponse {
 public:
  virtual ~LocalResponse() = default;
  /// See LocalDeformation::compliance().
  virtual MatX<double> compliance() const = 0;
  /// Adds to d_dot what pushes g do to the local coordinates.
  virtual void push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_dot) const = 0;
  /// Pushes on v_r and on all local coordinates become what they change the rates by.
  virtual void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const = 0;
};

/// What is recomputed at each evaluation, in the order of the stages; what one choice of S needs beside it is
/// in a type of its own.
struct LocalWorkspace {
  virtual ~LocalWorkspace() = default;

  /// Local coordinates and their rates, which stand in (q, v) of the evaluation.
  Eigen::Map<const VecX<double>> d{nullptr, 0}, d_dot{nullptr, 0};
  MatX<double> H0;      ///< M over (c, theta, q_s) at d = 0
  Vec3<double> moment;  ///< sum m p
  /// Of (c, theta, q_s), those that move nothing right now; they have no acceleration.
  std::bitset<kMaxVelocities> held;
  double damping = 0, drag = 0;  ///< powers of the local damping, and of the drag, W
  VecX<double> force;            ///< on the local coordinates
  VecX<double> a_free;           ///< (a_r, d_ddot at the shared points) without joints and limits
  /// M^-1 as joints see it, see compliance(), and its inverse where no points hold each other.
  MatX<double> A, A_inverse;
  const LocalResponse* response = nullptr;  ///< if there is one, it tells A

  /// n local coordinates and their rates, which must stay where they are as long as the workspace is used.
  void place(const double* q_d, const double* q_d_dot, Eigen::Index n) {
    new (&d) Eigen::Map<const VecX<double>>(q_d, n);
    new (&d_dot) Eigen::Map<const VecX<double>>(q_d_dot, n);
  }
  /// Of what tells (c, theta, q_s) and d apart; 1 at best.
  virtual double condition() const { return 1; }
  /// Takes A, whose rows depend on each other where points lie close together, and its inverse.
  void take_compliance(MatX<double> of_pushes);
};

/// q_j_ddot = -omega_j^2 q_j - D_j q_j_dot where nothing else acts on local coordinates.
struct Oscillators {
  VecX<double> omega2, damping;  ///< 1/s^2, 1/s
};

/// Energy of the motion and of the elasticity, J; momentum and angular momentum about the frame's origin,
/// body frame; first moment sum m p.
struct LocalMotion {
  double kinetic, elastic;
  Vec3<double> momentum, angular_momentum, moment;
};

class LocalDeformation {
 public:
  virtual ~LocalDeformation() = default;

  /// The mesh by which it is shown.
  const LocalMesh& mesh() const { return mesh_; }
  /// Number of local coordinates.
  Eigen::Index n_d() const { return initial_.size(); }
  /// Local coordinates and their rates at time 0.
  const VecX<double>& initial() const { return initial_; }
  const VecX<double>& initial_rate() const { return initial_rate_; }
  /// Changes of (c, theta, q_s) at time 0 and of their rates, body frame, by displacements that the local
  /// coordinates cannot tell; empty: none.
  const VecX<double>& initial_frame() const { return initial_frame_; }
  const VecX<double>& initial_frame_rate() const { return initial_frame_rate_; }
  double alpha() const { return alpha_; }
  double beta() const { return beta_; }
  /// "d[17].x": the name of a local coordinate, and its unit.
  virtual std::string coordinate_name(Eigen::Index k) const = 0;
  virtual const char* unit(Eigen::Index k) const = 0;
  /// Microseconds that an evaluation takes at the least, by which threads are chosen.
  virtual double cost() const = 0;
  /// "600 local, of 200 nodes": in words.
  virtual std::string description() const = 0;

  /// Of a material point; none where the local deformation does not reach, inside a shell.
  virtual NodeWeights weights(const Part& part, const Material<double>& m) const = 0;
  /// What local coordinates, or their rates, are at the nodes that weights tell of. buffer: may hold them.
  virtual Eigen::Map<const Nodes> at_nodes(const double* q_d, VecX<double>& buffer) const = 0;
  /// Displacements of the nodes of mesh(), m.
  virtual Nodes displacements(const double* q_d) const = 0;
  /// Those of some of them, columns.
  virtual Eigen::Matrix3Xd displacements(const double* q_d, const std::vector<int>& nodes) const = 0;
  /// The deformation by nodes, or by modes, if it is one.
  virtual const NodalDeformation* nodal() const { return nullptr; }
  virtual const ModalDeformation* modal() const { return nullptr; }
  /// What its coordinates are by themselves, where its elasticity is diagonal.
  virtual const Oscillators* oscillators() const { return nullptr; }

  // The dynamics, stage after stage, body frame. v_r = (R^T c_dot, omega, q_s_dot). Each takes a workspace
  // that workspace() made, in which place() has set d and d_dot.

  virtual std::unique_ptr<LocalWorkspace> workspace() const = 0;
  virtual void positions(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r,
                         LocalWorkspace& work, Counters& counters) const = 0;
  virtual void masses(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r,
                      LocalWorkspace& work, Counters& counters) const = 0;
  /// Inertial forces, gravity g, drag nu, elasticity and its damping.
  virtual void forces(const VecX<double>& v_r, const Vec3<double>& g, double nu, LocalWorkspace& work,
                      ThreadPool* pool) const = 0;
  /// Adds a force on a material point; what it does to (c, theta, q_s) is told apart.
  virtual void push(const NodeWeights& at, const Vec3<double>& force, LocalWorkspace& work) const = 0;
  /// f_r: what acts on (c, theta, q_s) beside the forces above; becomes a_r. Fills d_ddot, as long as d.
  virtual void accelerations(VecX<double>& f_r, LocalWorkspace& work,
                             Eigen::Ref<VecX<double>> d_ddot) const = 0;
  /// A = M^-1 as the joints of a part see it: what pushes g on (v_r, the points) do to (v_r, d_dot at the
  /// points).
  void compliance(const std::vector<NodeWeights>& points, LocalWorkspace& work) const;
  /// Adds to d_dot what such pushes do to the local coordinates.
  void push_all(const std::vector<NodeWeights>& points, const VecX<double>& g, const LocalWorkspace& work,
                Eigen::Ref<VecX<double>> d_dot) const;
  /// M of rigid motion at the positions now: 6 x 6.
  virtual Eigen::Matrix<double, 6, 6> rigid_inertia(const LocalWorkspace& work) const = 0;
  virtual LocalMotion motion(const VecX<double>& v_r, const LocalWorkspace& work) const = 0;

  /// No less than the largest omega^2 of its elasticity, 1/s^2, and its damping by beta, 1/s.
  struct Bound {
    double K = 0, D = 0;
  };
  virtual Bound stiffness_bound(const LocalWorkspace& work) const = 0;
  /// 1/kg of a material point, were its local coordinates alone to move.
  virtual double mobility(const NodeWeights& at) const = 0;

 protected:
  LocalDeformation(double alpha, double beta) : alpha_(alpha), beta_(beta) {}

  LocalMesh mesh_;
  VecX<double> initial_, initial_rate_, initial_frame_, initial_frame_rate_;

  /// compliance() and push_all() by M^-1.
  virtual MatX<double> own_compliance(const std::vector<NodeWeights>& points, LocalWorkspace& work) const = 0;
  virtual void own_push_all(const std::vector<NodeWeights>& points, const VecX<double>& g,
                            const LocalWorkspace& work, Eigen::Ref<VecX<double>> d_dot) const = 0;

  /// Throws std::invalid_argument when points are displaced by more than the size of the part at time 0.
  static void check_start(const Part& part, const Nodes& displacements, const VecX<double>& rates);

 private:
  double alpha_, beta_;
};

/// The energies of a part on a mesh.
struct LaidEnergies {
  std::vector<std::unique_ptr<NodalEnergy>> all;
  VecX<double> own_inertia;  ///< of the coordinates that one of them has of its own
};
/// Throws LocalFault where one cannot be laid, or a second one has coordinates of its own.
LaidEnergies lay_energies(const Part& part, const LocalSettings& settings, const LocalMesh& mesh);

/// Throws LocalFault when the mesh or an energy cannot be laid; the message names the part.
std::unique_ptr<LocalDeformation> make_local_deformation(const Part& part, const LocalSettings& settings);

/// Values of nodes at points, three a point.
VecX<double> at_points(const std::vector<NodeWeights>& points, const Eigen::Ref<const Nodes>& values);

}  // namespace pliant
