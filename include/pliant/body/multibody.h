// MultiBody: parts, joints and loads. A library user or a scene adds these objects; Model prepares the
// MultiBody for a run.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <pliant/body/actuation/drive.h>
#include <pliant/body/actuation/joint_coordinate.h>
#include <pliant/body/constraint/stabilization.h>
#include <pliant/body/contact_settings.h>
#include <pliant/body/distributed/distributed_force.h>
#include <pliant/body/joints/joint.h>
#include <pliant/body/joints/joint_setting.h>
#include <pliant/body/points.h>
#include <pliant/part/primitive.h>
#include <pliant/solve/joint_solver.h>

namespace pliant {

/// A linear spring and damper between two points a and b, with stiffness k and damping c. d is the vector
/// from a to b. With rest length 0 the force on b is -k d - c d_dot. With a rest length > 0 the force on b is
/// -(k (|d| - rest length) + c times the rate of |d|) d / |d|, and zero while |d| = 0. The force on a is
/// opposite. If stiffness, damping or rest length changes, the spring is a muscle: the ledger has the work of
/// its elastic force as actuation, and no energy of the spring.
struct Spring {
  std::string name;
  Point a, b;
  StateFunction stiffness;    ///< N/m
  StateFunction damping;      ///< N s/m
  StateFunction rest_length;  ///< m
  /// The spring acts at the times on <= t < off, s. At other times it has no force and no energy, and does
  /// not influence the length of steps. The energy that appears at `on` and disappears at `off` is work of
  /// anchors (Work::anchors) in the ledger. `on` and `off` must not change while a step is computed.
  double on = -std::numeric_limits<double>::infinity(), off = std::numeric_limits<double>::infinity();
  bool acts_at(double t) const { return on <= t && t < off; }

  bool is_constant() const {
    return stiffness.is_constant() && damping.is_constant() && rest_length.is_constant();
  }
  /// Returns the energy of the spring, J; 0 for a muscle. x_a, x_b: positions of its ends, m, world.
  double energy(const Vec3<double>& x_a, const Vec3<double>& x_b) const {
    if (!is_constant()) return 0;
    const double stretch = (x_b - x_a).norm() - rest_length.constant();
    return 0.5 * stiffness.constant() * stretch * stretch;
  }
};

enum class Frame { world, body };

/// A force at a material point.
struct PointForce {
  std::string name;
  Point at;
  StateVector force;  ///< N
  Frame frame = Frame::world;
  /// A function of the library user. If it is set, its result (N, world) replaces `force`. Arguments: time,
  /// position and velocity of the point in the world. Directional derivatives (Dynamics::jvp) treat the force
  /// as constant. During a step, the processor replaces numbers of magnitude below 2e-308 by zero.
  std::function<Vec3<double>(double t, const Vec3<double>& x, const Vec3<double>& x_dot)> custom;
};

/// A torque on the frame of a part. If there is a part `against`, the opposite torque acts on this part. The
/// torque is then internal, like the torque of a motor or a muscle, and conserves the total momenta.
struct Torque {
  std::string name;
  const Part* part = nullptr;
  StateVector torque;             ///< N m
  Frame frame = Frame::world;     ///< Frame::body: the frame of `part`
  const Part* against = nullptr;  ///< nullptr: an external torque
};

class MultiBody {
 public:
  Vec3<double> gravity{0, 0, -9.81};           ///< m/s^2
  std::optional<TimeVector> changing_gravity;  ///< gravity that changes in time; it replaces `gravity`
  Stabilization stabilization;
  JointSolver joint_solver;
  ContactSettings contact;
  /// Rate of stops, 1/s. No step crosses a multiple of 1 / stop_rate. 0: steps may end at any time. Each
  /// multiple is a kink (Model::next_kink). A load that changes at a multiple then has no influence on
  /// earlier steps.
  double stop_rate = 0;

  /// Adds a part. Returns a reference to the part, which is valid as long as the MultiBody exists. Throws
  /// std::invalid_argument if the name is in use or empty.
  template <class P, class... Args>
  P& add(std::string name, Args&&... args) {
    auto part = std::make_unique<P>(std::move(name), std::forward<Args>(args)...);
    P& reference = *part;
    add(std::move(part));
    return reference;
  }
  Part& add(std::unique_ptr<Part> part);

  /// Prepares a part that is in this body, or that will be added to it. Parts with equal descriptions share
  /// their constants (part/constants_cache.h). Throws the exceptions of Part::prepare(). Only one thread at a
  /// time may call this function.
  void prepare(Part& part) const { part.prepare(constants_); }
  /// Number of constants that prepare() has computed for sharing. Parts that share constants count
  /// once; parts that deform locally or have a mass distribution do not count.
  std::size_t n_computed() const { return constants_.computed(); }

  /// Adds a spring between two points: stiffness (N/m), damping (N s/m) and rest length (m). Throws
  /// std::invalid_argument if one of these is a constant that is negative or not finite.
  Spring& spring(std::string name, Point a, Point b, StateFunction stiffness, StateFunction damping = 0,
                 StateFunction rest_length = 0);
  /// Removes a spring of this MultiBody. No Model that contains the spring may exist.
  void remove(const Spring& spring);
  void remove(const Drive& drive);
  /// Adds a force (N) at a material point. frame: the frame of its components.
  PointForce& force(std::string name, Point at, StateVector force, Frame frame = Frame::world);
  /// Adds a force at a material point by a function, see PointForce::custom.
  PointForce& force(std::string name, Point at,
                    std::function<Vec3<double>(double, const Vec3<double>&, const Vec3<double>&)> custom);
  /// Adds a torque (N m) on a part. frame: the frame of its components.
  Torque& torque(std::string name, const Part& part, StateVector torque, Frame frame = Frame::world);

  /// Adds a force on the surface of a part: a traction (N/m^2, world) and a pressure (N/m^2) along the inward
  /// normal. The formulas may read quantities_at_points().
  DistributedForce& surface_force(std::string name, const Part& part, StateVector traction,
                                  StateFunction pressure = 0);
  /// Adds a force per mass (N/kg, world) in the body of a part. The formulas may read quantities_at_points().
  DistributedForce& body_force(std::string name, const Part& part, StateVector per_mass);

  /// Returns the coordinate of a hinge (angle, rad), slider (position, m) or ball joint (twist and two
  /// components of the swing, rad), for signals and drives. The coordinate is zero at time 0 with undeformed
  /// parts, except for a slider, for a hinge with from_axis and for a ball joint with BallAxes::rotation.
  /// Later calls for the same joint return the result of the first call. Throws std::invalid_argument for
  /// joints of other types.
  const Joint& coordinate(const Joint& joint, const BallAxes& ball = {});
  /// Limits the angle of a hinge (rad) or the position of a slider (m) to [lower, upper], with a restitution
  /// from 0 to 1. Adds the one-sided joints "NAME.lower" and "NAME.upper". Throws std::invalid_argument for
  /// joints of other types, unless lower < upper, and for a hinge unless upper - lower < 2 pi - 0.1.
  void limit(const Joint& joint, double lower, double upper, double restitution = 0);
  /// limit_swing() limits the swing of a ball joint, the angle between the axes of both sides, to at most max
  /// (rad), between 0 and pi - 0.05. The function adds the one-sided joint "NAME.swing". limit_twist() limits
  /// the twist to [lower, upper] (rad) and adds "NAME.lower" and "NAME.upper". The coordinate of the joint
  /// defines the axes. Both functions throw std::invalid_argument for other numbers and other joints.
  void limit_swing(const Joint& joint, double max, double restitution = 0);
  void limit_twist(const Joint& joint, double lower, double upper, double restitution = 0);
  /// Adds a drive on a row of a coordinate, or on a dynamic parameter of a part. The drive has no force until
  /// its members are set. Throws std::invalid_argument if the parameter is not dynamic.
  Drive& drive(std::string name, const Joint& coordinate, int row = 0);
  Drive& drive(std::string name, const Part& part, const std::string& parameter);
  /// Adds an input: a number that the controller of a simulation sets (Simulation::set_controller) and that
  /// formulas read by its name. Returns its index in State::inputs. Throws std::invalid_argument if the name
  /// is in use or empty.
  int input(std::string name, double initial = 0);
  /// Adds a sensor. Throws std::invalid_argument if the name is in use or empty.
  const Sensor& sensor(std::string name, StateFunction value);

  /// Returns gravity at time t (s), m/s^2, world.
  Vec3<double> gravity_at(double t) const { return changing_gravity ? changing_gravity->value(t) : gravity; }

  /// Adds a joint by its formula (body/joints/*.h). points: the points of its first side, then those of the
  /// second side. Throws std::invalid_argument if the name is in use or empty, if the formula is invalid or
  /// needs another number of points, or if the points of a side are not on one part.
  template <class F>
  JointOf<F>& join(std::string name, F formula, std::vector<Point> points) {
    auto joint = std::make_unique<JointOf<F>>(std::move(name), std::move(points), std::move(formula));
    JointOf<F>& reference = *joint;
    join(std::move(joint));
    return reference;
  }
  Joint& join(std::unique_ptr<Joint> joint);
  /// Adds the point-to-point joint: two points coincide.
  Joint& ball(std::string name, Point a, Point b);
  /// Adds a joint by the name of its type, for instance "hinge" (body/joints/joint_registry.h). Prepares its
  /// parts; their rest values and placements must be set before the call. Throws std::invalid_argument for an
  /// unknown type or an invalid setting.
  Joint& join(const std::string& type, std::string name, const JointSetting& setting);
  /// Adds a hinge. axis: the direction of its pin in the frame of the part of b, or in the world if b is a
  /// point of the world. The direction in the part of a follows from the placement of the undeformed parts.
  Joint& hinge(std::string name, Point a, Point b, const Vec3<double>& axis);
  /// Adds a weld, which keeps the relative placement of the undeformed parts.
  Joint& weld(std::string name, Point a, Point b);

  /// Adds an impenetrable plane through a point (m, world) with a normal (world, of any length > 0), and
  /// activates contact. Throws std::invalid_argument if the normal has no direction or the name is in use.
  ContactPlane& plane(std::string name, TimeVector point, const Vec3<double>& normal);
  /// Adds an immobile triangle mesh (vertices: m, world; triangles: counter-clockwise seen from the free
  /// side) and activates contact. Throws std::invalid_argument if the name is in use. The constructor of
  /// Simulation checks the mesh.
  ContactObstacle& obstacle(std::string name, Eigen::Matrix3Xd vertices, Eigen::Matrix3Xi triangles);
  /// Adds a rectangle without thickness that is solid from both sides. middle: m, world. orientation: from
  /// the frame of the rectangle to the world. The x and y axes of this frame are along the edges; half_x and
  /// half_y are its half extents (m). Throws std::invalid_argument unless the half extents are finite and
  /// positive, or if the name is in use.
  ContactObstacle& plate(std::string name, const Vec3<double>& middle, const Eigen::Quaterniond& orientation,
                         double half_x, double half_y);

  const std::vector<std::unique_ptr<Part>>& parts() const { return parts_; }
  const std::vector<std::unique_ptr<Spring>>& springs() const { return springs_; }
  const std::vector<std::unique_ptr<PointForce>>& forces() const { return forces_; }
  const std::vector<std::unique_ptr<Torque>>& torques() const { return torques_; }
  const std::vector<std::unique_ptr<DistributedForce>>& distributed_forces() const { return distributed_; }
  const std::vector<std::unique_ptr<Joint>>& joints() const { return joints_; }
  const std::vector<std::unique_ptr<Joint>>& coordinates() const { return coordinates_; }
  const std::vector<std::unique_ptr<Drive>>& drives() const { return drives_; }
  const std::vector<std::unique_ptr<Sensor>>& sensors() const { return sensors_; }
  const std::vector<Input>& inputs() const { return inputs_; }
  /// Returns the part with a name; nullptr if there is none.
  Part* find(const std::string& name) const;
  bool has_joint(const std::string& name) const { return joint_names_.count(name) > 0; }
  /// Returns the number of a part of this MultiBody. Throws std::invalid_argument for other parts.
  int index(const Part& part) const;

 private:
  /// Adds the one-sided joints of a limit, which act during the same times as the joint.
  void add_limits(const Joint& joint, std::vector<std::unique_ptr<Joint>> limits);

  std::vector<std::unique_ptr<Part>> parts_;
  mutable ConstantsCache constants_;                // Model prepares the parts of a const MultiBody
  std::unordered_map<std::string, int> number_of_;  // keys: names of parts
  std::vector<std::unique_ptr<Spring>> springs_;
  std::vector<std::unique_ptr<PointForce>> forces_;
  std::vector<std::unique_ptr<Torque>> torques_;
  std::vector<std::unique_ptr<DistributedForce>> distributed_;
  std::vector<std::unique_ptr<Joint>> joints_;
  std::unordered_set<std::string> joint_names_;
  std::vector<std::unique_ptr<Joint>> coordinates_;  // each has the name of its joint
  std::vector<std::unique_ptr<Drive>> drives_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::vector<Input> inputs_;
};

}  // namespace pliant
