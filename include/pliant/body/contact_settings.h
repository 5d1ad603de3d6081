// Who touches whom: planes, obstacles, friction and restitution, and pairs that are out of the ordinary.
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

/// Whether something that is there from `on` until `off` is so in a step that ends at a time t; steps end at
/// such times, but for rounding. s.
inline bool there_before(double t, double on, double off) {
  constexpr double kRounding = 1e-12;
  return (on <= 0 || t > on * (1 + kRounding)) && t <= off * (1 + kRounding);
}

/// An immobile, impenetrable half space below a plane, or one that is moved by hand.
struct ContactPlane {
  std::string name;
  TimeVector point;                                      ///< on the plane, m, world
  Vec3<double> normal = {0, 0, 1};                       ///< of length 1, out of the half space, world
  double on = 0;                                         ///< it is there from this time, s
  double off = std::numeric_limits<double>::infinity();  ///< until that, s

  bool acts_at(double t) const { return on <= t && t < off; }
  bool acts_before(double t) const { return there_before(t, on, off); }
  /// Over h seconds from t on the most of its height along its normal, m, at kMoments.
  double highest(double t, double h) const {
    if (point.is_constant()) return normal.dot(point.value(t));
    double most = -std::numeric_limits<double>::infinity();
    for (const double share : kMoments) most = std::max(most, normal.dot(point.value(t + share * h)));
    return most;
  }
};

/// An immobile body whose surface is a triangle mesh, one-sided where it is open (contact/obstacle_mesh.h).
struct ContactObstacle {
  std::string name;
  Eigen::Matrix3Xd vertices;   ///< m, world
  Eigen::Matrix3Xi triangles;  ///< columns of these, counter-clockwise seen from the side that is free
  double on = 0;               ///< it is there from this time, s
  double off = std::numeric_limits<double>::infinity();  ///< until that, s

  bool acts_at(double t) const { return on <= t && t < off; }
  bool acts_before(double t) const { return there_before(t, on, off); }
};

/// Parts, planes and obstacles that pairs can name together.
struct ContactGroup {
  std::string name;
  std::vector<std::string> members;
};

/// How two things touch that are named: parts, planes, obstacles or groups; a group with itself says it of
/// its members. Of several pairs that two things are in, that with the fewest groups counts, and of these the
/// last.
struct ContactPair {
  std::string a, b;
  bool touch = true;                                ///< false: they pass through each other
  std::optional<double> friction{}, restitution{};  ///< those of the settings where not given
};

/// Bodies that have been at rest for long enough, and all that they touch and are tied to with them, sleep:
/// they are neither evaluated nor searched for contacts with each other until an awake body meets them, or
/// what drives them changes: a joint switches, the end of a spring or joint, a force, a rest value, a plane
/// or gravity moves.
struct Sleep {
  double speed = 0;    ///< of the fastest point of a body that counts as resting, m/s; above 0
  double after = 0.5;  ///< for how long it does, s; above 0
};

struct ContactSettings {
  bool active = false;        ///< whether anything touches at all
  bool between_parts = true;  ///< whether parts touch parts, or planes and obstacles alone
  double friction = 0.5;      ///< Coulomb's coefficient mu
  double restitution = 0;     ///< Newton's coefficient e: speed after an impact over that before
  /// Parts that a joint ties together touch only where a pair names both.
  std::vector<ContactPair> pairs;
  std::vector<ContactGroup> groups;
  std::deque<ContactPlane> planes;
  std::deque<ContactObstacle> obstacles;
  std::optional<Sleep> sleep{};  ///< not given: nothing sleeps
  /// Of steps to a tolerance of 5e-4 or less in which many bodies lie on each other, or some that deform
  /// locally, whose error is not controlled (contact_step.h), or any where forces act, s; above 0.
  double longest_step = 2e-3;
};

}  // namespace pliant
