// How a joint is set up by the name of its type: what scenes say, and MultiBody's functions for common
// joints.
#pragma once

#include <initializer_list>
#include <optional>

#include <Eigen/Geometry>

#include <pliant/body/points.h>

namespace pliant {

struct JointSetting {
  Point from, to;     ///< its points x_0 and x_1 (weld: x_0 and y_0)
  double length = 0;  ///< of a rod or string, m
  /// A direction at `to`, in the frame of its part at rest or of the world: normal, line or hinge pin.
  Vec3<double> axis{0, 0, 1};
  /// The pin of a hinge at `from` likewise; the direction that `axis` has at time 0, the
  /// parts undeformed, when not given.
  std::optional<Vec3<double>> from_axis{};
  /// Orientation of the frame at `from` in that at `to`; as they stand at time 0, the parts
  /// undeformed, when not given.
  std::optional<Eigen::Quaterniond> rotation{};
};

/// What of a setting, beside the points, a type of joint uses.
enum class JointKey : unsigned { length = 1, axis = 2, from_axis = 4, rotation = 8 };

/// A set of them.
struct JointKeys {
  unsigned set = 0;
  constexpr JointKeys() = default;
  constexpr JointKeys(std::initializer_list<JointKey> keys) {
    for (const JointKey key : keys) set |= static_cast<unsigned>(key);
  }
  constexpr bool has(JointKey key) const { return (set & static_cast<unsigned>(key)) != 0; }
};

}  // namespace pliant
