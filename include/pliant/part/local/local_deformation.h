// The local deformation of a part, d = S q_d, Eq. (5): local coordinates q_d give the displacements d of the
// material points in the frame of the part. Displacements d can also represent rigid motion and changes of
// the global parameters q_s; reference conditions W^T d = 0 remove this redundancy
// (include/pliant/part/local/README.md). LocalDeformation is the interface of all choices of the shape matrix
// S. Each call handles a whole part. The choices of q_d are
//   nodal_deformation.h   displacements d of the nodes of a mesh
//   modal_deformation.h   amplitudes q_j of global modes Phi_j: d = sum Phi_j q_j
// The displacement of a material point is d = sum weight_i d_i: weights() gives the weights, and at_nodes()
// computes the nodal values d_i from q_d.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/math/thread_pool.h>
#include <pliant/part/local/local_mesh.h>
#include <pliant/part/local/local_settings.h>
#include <pliant/part/local/local_workspace.h>

namespace pliant {

class ModalDeformation;
class NodalDeformation;
class Part;
struct Counters;

/// Independent oscillators: q_j_ddot = -omega_j^2 q_j - D_j q_j_dot if nothing else acts on the local
/// coordinates.
struct Oscillators {
  VecX<double> omega2, damping;  ///< 1/s^2, 1/s
};

/// Energies and momenta of a part that deforms locally.
struct LocalMotion {
  double kinetic, elastic;  ///< J
  /// Body frame: momentum (kg m/s), angular momentum about the origin (kg m^2/s), sum m p (kg m).
  Vec3<double> momentum, angular_momentum, moment;
};

class LocalDeformation {
 public:
  virtual ~LocalDeformation() = default;

  /// Returns the mesh. Its surface is used for pictures and for contact detection.
  const LocalMesh& mesh() const { return mesh_; }
  /// Number of local coordinates.
  Eigen::Index n_d() const { return initial_.size(); }
  /// Local coordinates and their rates at time 0.
  const VecX<double>& initial() const { return initial_; }
  const VecX<double>& initial_rate() const { return initial_rate_; }
  /// Changes of (c, theta, q_s), body frame, and of their rates at time 0. These changes represent the share
  /// of the initial displacements and velocities that modes cannot represent. Empty: no changes.
  const VecX<double>& initial_frame() const { return initial_frame_; }
  const VecX<double>& initial_frame_rate() const { return initial_frame_rate_; }
  /// Damping by mass: factor alpha, 1/s. Damping by stiffness: factor beta, s.
  double alpha() const { return alpha_; }
  double beta() const { return beta_; }
  /// Returns the name of local coordinate number k, for example "d[17].x" or "mode[3]".
  virtual std::string coordinate_name(Eigen::Index k) const = 0;
  /// Returns the unit of local coordinate number k.
  virtual const char* unit(Eigen::Index k) const = 0;
  /// Returns a low estimate of the time of an evaluation, in microseconds. The choices of the number of
  /// threads (io) and of the integrator (simulate) use this time.
  virtual double cost() const = 0;
  /// Returns the number and the kind of the local coordinates for `pliant info`, for example "600 local, of
  /// 200 nodes and 396 triangles; laws: ..." for 600 local coordinates.
  virtual std::string description() const = 0;

  /// Returns the weights of a material point over the nodes of at_nodes(). The result is empty for a point
  /// inside a shell, where the local deformation has no value.
  virtual NodeWeights weights(const Part& part, const Material<double>& m) const = 0;
  /// Returns the values at the nodes of weights(): displacements (m) from local coordinates, or velocities
  /// (m/s) from their rates. buffer: storage that the result may refer to.
  virtual Eigen::Map<const Nodes> at_nodes(const double* q_d, VecX<double>& buffer) const = 0;
  /// Returns the displacements of the nodes of mesh(), m.
  virtual Nodes displacements(const double* q_d) const = 0;
  /// Returns the displacements of the given nodes of mesh(), m: one column for each node.
  virtual Eigen::Matrix3Xd displacements(const double* q_d, const std::vector<int>& nodes) const = 0;
  /// Returns this object if it is a NodalDeformation, else nullptr.
  virtual const NodalDeformation* nodal() const { return nullptr; }
  /// Returns this object if it is a ModalDeformation, else nullptr.
  virtual const ModalDeformation* modal() const { return nullptr; }
  /// Returns the oscillators if the elasticity is diagonal in the local coordinates, else nullptr.
  virtual const Oscillators* oscillators() const { return nullptr; }

  // The dynamics in the body frame, with v_r = (R^T c_dot, omega, q_s_dot). The stages are those of
  // include/pliant/body/README.md; this class has no stage 4, the joints. The workspace must come from
  // workspace(), and LocalWorkspace::place() must have set d and d_dot.

  virtual std::unique_ptr<LocalWorkspace> workspace() const = 0;
  /// Stage 1: computes the positions p = s + d of the nodes or spectral nodes (modal_basis.h).
  virtual void positions(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r,
                         LocalWorkspace& work, Counters& counters) const = 0;
  /// Stage 2: computes the mass matrix over (c, theta, q_s) and factors the matrix of the reference
  /// conditions.
  virtual void masses(const Part& part, const VecX<double>& q_s, const VecX<double>& v_r,
                      LocalWorkspace& work, Counters& counters) const = 0;
  /// Stage 3: computes inertial forces, gravity g (m/s^2), drag nu (1/s), elasticity and its damping. pool:
  /// threads, or nullptr.
  virtual void forces(const VecX<double>& v_r, const Vec3<double>& g, double nu, LocalWorkspace& work,
                      ThreadPool* pool) const = 0;
  /// Stage 3, loads: adds a force (N, body frame) on a material point to the forces on the local coordinates.
  /// The caller adds the generalised force on (c, theta, q_s) to the argument f_r of accelerations().
  virtual void push(const NodeWeights& at, const Vec3<double>& force, LocalWorkspace& work) const = 0;
  /// Stage 5: solves for the accelerations. f_r: on input the generalised forces on (c, theta, q_s), without
  /// the contributions of forces(); on output the accelerations a_r of (c, theta, q_s), body frame. d_ddot:
  /// output, the accelerations of the local coordinates.
  virtual void accelerations(VecX<double>& f_r, LocalWorkspace& work,
                             Eigen::Ref<VecX<double>> d_ddot) const = 0;

  /// Computes A = M^-1 for the joints of the part, or the compliance of work.response if there is one, and
  /// stores A in the workspace. A maps impulses g on (v_r, the points) to the changes of (v_r, d_dot at the
  /// points). points: the attachment points of the joints.
  void compliance(const std::vector<NodeWeights>& points, LocalWorkspace& work) const;
  /// Adds to d_dot the changes of all local rates that impulses g on (v_r, the points) cause. compliance()
  /// must have run on the workspace with these points.
  void push_all(const std::vector<NodeWeights>& points, const VecX<double>& g, const LocalWorkspace& work,
                Eigen::Ref<VecX<double>> d_dot) const;
  /// Returns M over (c, theta) at the current positions: 6 x 6.
  virtual Eigen::Matrix<double, 6, 6> rigid_inertia(const LocalWorkspace& work) const = 0;
  /// Returns energies and momenta at the current positions and velocities.
  virtual LocalMotion motion(const VecX<double>& v_r, const LocalWorkspace& work) const = 0;

  /// Upper bounds of the largest omega^2 of the elasticity, 1/s^2, and of its damping by beta, 1/s.
  struct Bound {
    double K = 0, D = 0;
  };
  /// Returns both bounds at the current positions.
  virtual Bound stiffness_bound(const LocalWorkspace& work) const = 0;
  /// Returns the inverse of the effective mass (1/kg) of a material point if only the local coordinates move.
  /// For modes the result is the largest value over all directions.
  virtual double mobility(const NodeWeights& at) const = 0;

 protected:
  LocalDeformation(double alpha, double beta) : alpha_(alpha), beta_(beta) {}

  LocalMesh mesh_;
  VecX<double> initial_, initial_rate_, initial_frame_, initial_frame_rate_;

  /// compliance() and push_all() call these two functions, which use M^-1, if the workspace has no
  /// LocalResponse. A step that is implicit in the elasticity supplies a LocalResponse instead of M^-1.
  virtual MatX<double> inertial_compliance(const std::vector<NodeWeights>& points,
                                           LocalWorkspace& work) const = 0;
  virtual void inertial_push_all(const std::vector<NodeWeights>& points, const VecX<double>& g,
                                 const LocalWorkspace& work, Eigen::Ref<VecX<double>> d_dot) const = 0;

  /// Throws std::invalid_argument if a node is displaced by more than Part::size() at time 0, or if a rate is
  /// not finite.
  static void check_start(const Part& part, const Nodes& displacements, const VecX<double>& rates);

 private:
  double alpha_, beta_;
};

/// Returns the local deformation of a part. Throws LocalFault if the mesh, the modes or an energy cannot be
/// made; the message names the part.
std::unique_ptr<LocalDeformation> make_local_deformation(const Part& part, const LocalSettings& settings);

/// Returns the values of a nodal vector field at points: three numbers for each point. values: the field, one
/// row for each node.
VecX<double> at_points(const std::vector<NodeWeights>& points, const Eigen::Ref<const Nodes>& values);

}  // namespace pliant
