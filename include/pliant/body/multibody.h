// MultiBody: parts, the joints that tie them, and what acts on them. This is what a library user or a scene
// fills in; Model makes it ready to run.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <pliant/body/constraint/stabilization.h>
#include <pliant/body/contact_settings.h>
#include <pliant/body/joints/ball.h>
#include <pliant/body/joints/joint.h>
#include <pliant/body/joints/joint_setting.h>
#include <pliant/body/points.h>
#include <pliant/part/primitive.h>
#include <pliant/solve/joint_solver.h>

namespace pliant {

/// A linear spring and damper between two points. With rest length 0 it pulls with -k d - c d_dot along the
/// difference d of the points; else with -(k (|d| - length) + c d|d|/dt) along d, and with nothing while |d|
/// = 0.
struct Spring {
  std::string name;
  Point a, b;
  double stiffness = 0;    ///< N/m
  double damping = 0;      ///< N s/m
  double rest_length = 0;  ///< m
};

enum class Frame { world, body };

/// A force at a material point.
struct PointForce {
  std::string name;
  Point at;
  TimeVector force;  ///< N
  Frame frame = Frame::world;
  /// Library users: a force of their own instead (t, position and velocity in the world -> N in the world).
  /// Directional derivatives (jvp) take it as constant. Within steps numbers below 2e-308 are zero.
  std::function<Vec3<double>(double t, const Vec3<double>& x, const Vec3<double>& x_dot)> custom;
};

/// A torque on the rotation of a part's frame; against another part, on which its opposite acts, it is from
/// inside, as of a motor or a muscle, and leaves their momenta as they are.
struct Torque {
  std::string name;
  const Part* part = nullptr;
  TimeVector torque;              ///< N m
  Frame frame = Frame::world;     ///< body: of `part`
  const Part* against = nullptr;  ///< nullptr: it is from outside
};

class MultiBody {
 public:
  Vec3<double> gravity{0, 0, -9.81};           ///< m/s^2
  std::optional<TimeVector> changing_gravity;  ///< instead of it
  Stabilization stabilization;
  JointSolver joint_solver;
  ContactSettings contact;

  /// Adds a part; the reference stays valid. Throws std::invalid_argument when the name is taken or empty.
  template <class P, class... Args>
  P& add(std::string name, Args&&... args) {
    auto part = std::make_unique<P>(std::move(name), std::forward<Args>(args)...);
    P& reference = *part;
    add(std::move(part));
    return reference;
  }
  Part& add(std::unique_ptr<Part> part);

  /// A spring (N/m), damper (N s/m) and rest length (m) between two points.
  Spring& spring(std::string name, Point a, Point b, double stiffness, double damping = 0,
                 double rest_length = 0);
  PointForce& force(std::string name, Point at, TimeVector force, Frame frame = Frame::world);
  PointForce& force(std::string name, Point at,
                    std::function<Vec3<double>(double, const Vec3<double>&, const Vec3<double>&)> custom);
  Torque& torque(std::string name, const Part& part, TimeVector torque, Frame frame = Frame::world);

  Vec3<double> gravity_at(double t) const { return changing_gravity ? changing_gravity->value(t) : gravity; }

  /// A joint of a formula (body/joints/*.h) over the points of its first side, then those of its second.
  /// Throws std::invalid_argument when the points of a side are not on one part.
  template <class F>
  JointOf<F>& join(std::string name, F formula, std::vector<Point> points) {
    auto joint = std::make_unique<JointOf<F>>(std::move(name), std::move(points), std::move(formula));
    JointOf<F>& reference = *joint;
    join(std::move(joint));
    return reference;
  }
  Joint& join(std::unique_ptr<Joint> joint);
  /// The point-to-point joint: two points coincide.
  Joint& ball(std::string name, Point a, Point b) {
    return join(std::move(name), Ball{}, {std::move(a), std::move(b)});
  }
  /// A joint of a type by name, "hinge" say (body/joint_registry.h), over parts as they are by now: their
  /// rest values and places are to be set before. Throws std::invalid_argument.
  Joint& join(const std::string& type, std::string name, const JointSetting& setting);
  /// A hinge whose pin has a direction in the frame of b's part (or of the world), and for a the same as the
  /// parts are placed; a weld of the parts as they are placed, undeformed.
  Joint& hinge(std::string name, Point a, Point b, const Vec3<double>& axis);
  Joint& weld(std::string name, Point a, Point b);

  /// An impenetrable plane through a point (m, world), and with it contact. Throws std::invalid_argument when
  /// the normal has no direction or the name is taken.
  ContactPlane& plane(std::string name, TimeVector point, const Vec3<double>& normal);
  /// An immobile triangle mesh (vertices: m, world; triangles: counter-clockwise seen from the side that is
  /// free), and with it contact. Throws std::invalid_argument when the name is taken; a Model tells what else
  /// is wrong with it.
  ContactObstacle& obstacle(std::string name, Eigen::Matrix3Xd vertices, Eigen::Matrix3Xi triangles);
  /// A rectangle without thickness that is solid from both sides: x and y of its frame run along its edges,
  /// and it reaches this far along them to either side of its middle (m). Throws std::invalid_argument.
  ContactObstacle& plate(std::string name, const Vec3<double>& middle, const Eigen::Quaterniond& orientation,
                         double half_x, double half_y);

  const std::vector<std::unique_ptr<Part>>& parts() const { return parts_; }
  const std::vector<std::unique_ptr<Spring>>& springs() const { return springs_; }
  const std::vector<std::unique_ptr<PointForce>>& forces() const { return forces_; }
  const std::vector<std::unique_ptr<Torque>>& torques() const { return torques_; }
  const std::vector<std::unique_ptr<Joint>>& joints() const { return joints_; }
  /// The part called name; nullptr if there is none.
  Part* find(const std::string& name) const;
  bool has_joint(const std::string& name) const { return joint_names_.count(name) > 0; }
  /// Number of a part of this body.
  int index(const Part& part) const;

 private:
  std::vector<std::unique_ptr<Part>> parts_;
  std::unordered_map<std::string, int> number_of_;  // by name
  std::vector<std::unique_ptr<Spring>> springs_;
  std::vector<std::unique_ptr<PointForce>> forces_;
  std::vector<std::unique_ptr<Torque>> torques_;
  std::vector<std::unique_ptr<Joint>> joints_;
  std::unordered_set<std::string> joint_names_;
};

}  // namespace pliant
