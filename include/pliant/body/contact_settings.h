// Settings of contact: planes, obstacles, friction, restitution, and pairs with settings of their own.
#pragma once

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <pliant/math/time_function.h>

namespace pliant {

/// Returns whether an object that is present from `on` until `off` (s) is present in a step that ends at t
/// (s). The function assumes that steps end at the times `on` and `off`, within rounding.
inline bool present_before(double t, double on, double off) {
  constexpr double kRounding = 1e-12;
  return (on <= 0 || t > on * (1 + kRounding)) && t <= off * (1 + kRounding);
}

/// An impenetrable half space below a plane, immobile or with prescribed motion.
struct ContactPlane {
  std::string name;
  TimeVector point;                                      ///< a point on the plane, m, world
  Vec3<double> normal = {0, 0, 1};                       ///< unit normal, out of the half space, world
  double on = 0;                                         ///< the plane is present from this time, s
  double off = std::numeric_limits<double>::infinity();  ///< until this time, s

  bool acts_at(double t) const { return on <= t && t < off; }
  bool acts_before(double t) const { return present_before(t, on, off); }
  /// Returns the largest normal . point, m, from t to t + h (s), sampled at the fractions kMoments of this
  /// interval (math/time_function.h).
  double highest(double t, double h) const {
    if (point.is_constant()) return normal.dot(point.value(t));
    double largest = -std::numeric_limits<double>::infinity();
    for (const double share : kMoments) largest = std::max(largest, normal.dot(point.value(t + share * h)));
    return largest;
  }
};

/// An immobile solid whose surface is a triangle mesh; an open mesh is one-sided
/// (collision/mesh/obstacle_mesh.h).
struct ContactObstacle {
  std::string name;
  Eigen::Matrix3Xd vertices;   ///< m, world
  Eigen::Matrix3Xi triangles;  ///< columns of `vertices`, counter-clockwise seen from the free side
  double on = 0;               ///< the obstacle is present from this time, s
  double off = std::numeric_limits<double>::infinity();  ///< until this time, s

  bool acts_at(double t) const { return on <= t && t < off; }
  bool acts_before(double t) const { return present_before(t, on, off); }
};

/// Parts, planes and obstacles that a pair can name together.
struct ContactGroup {
  std::string name;
  std::vector<std::string> members;
};

/// Contact settings of two named parts, planes, obstacles or groups. A group paired with itself gives the
/// settings of contacts among its members. If several pairs match, the pair with the fewest groups applies;
/// among pairs with equally few groups, the last pair applies.
struct ContactPair {
  std::string a, b;
  bool touch = true;                                ///< false: a and b pass through each other
  std::optional<double> friction{}, restitution{};  ///< default: the values of ContactSettings
};

/// Sleeping. A part falls asleep when this part, and all parts that it touches or is joined to, have been at
/// rest for some time. Sleeping parts are not evaluated, and contacts between sleeping parts are not
/// searched. A sleeping part wakes when an awake part touches it, or when a cause of its motion changes. A
/// cause changes when a joint, spring, plane or obstacle is switched on or off. A cause also changes when the
/// prescribed end of a spring or joint moves, and when a load, a rest value, the factor of local stiffness or
/// gravity changes. A part stays awake while a cause changes, or while it touches a part or plane with
/// prescribed motion. Loads that read the state, and forces by a function (PointForce::custom), are regarded
/// as changing at all times. A distributed force that reads only its own points is regarded as constant.
struct Sleep {
  double speed = 0;    ///< a part is at rest while all its points are slower than this, m/s; must be > 0
  double after = 0.5;  ///< time at rest after which a part falls asleep, s; must be > 0
};

/// How impacts that happen at the same time are resolved.
enum class ImpactOrder {
  simultaneous,  ///< Newton's law of impact holds at all contacts at once
  sequential     ///< pairs of bodies collide one after another, the fastest first (contact/impact_sequence.h)
};

/// Smallest and largest value of ContactSettings::tolerance.
inline constexpr double kMinContactTolerance = 1e-14, kMaxContactTolerance = 0.1;

struct ContactSettings {
  bool active = false;        ///< whether there is any contact
  bool between_parts = true;  ///< whether parts touch each other; false: only planes and obstacles
  double friction = 0.5;      ///< Coulomb's coefficient mu
  double restitution = 0;     ///< Newton's coefficient e: speed after an impact / speed before the impact
  ImpactOrder impacts = ImpactOrder::simultaneous;
  /// Largest violation of the laws of contact, as a share of a reference speed. For a set of bodies that
  /// touch each other, the reference is the largest speed that contact impulses stop (contact/README.md). At
  /// rest this reference is the speed that gravity gives a body in a step. At an impact the reference is 1 +
  /// e times the speed of the impact. The relative error of the impulses may be larger, for instance in tall
  /// stacks. If no tolerance is given, only rounding errors are allowed.
  std::optional<double> tolerance{};
  /// Pairs with settings of their own. Two parts with a common joint touch only if a pair names both.
  std::vector<ContactPair> pairs;
  std::vector<ContactGroup> groups;
  std::deque<ContactPlane> planes;
  std::deque<ContactObstacle> obstacles;
  std::optional<Sleep> sleep{};  ///< not given: no part sleeps
  /// Longest step, s, in a run to a tolerance of 5e-4 or less, while bodies rest in contact and the error of
  /// contact is not controlled. This error is not controlled with many parts, with parts that deform locally
  /// and with point forces. Must be > 0. Larger tolerances allow longer steps
  /// (contact/longest_contact_step.h).
  double longest_step = 2e-3;
  /// Length of an interval, s. In a run to a tolerance, bodies that may meet within an interval step together
  /// in a cluster, independently of other bodies (simulate/clusters.h). Intervals end at the multiples of
  /// this length. Must be > 0.
  double interval = 1.0 / 128;
};

}  // namespace pliant
