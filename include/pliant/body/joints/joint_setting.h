// The settings of a joint. Scenes and the functions of MultiBody make a joint from the name of its type and
// its settings.
#pragma once

#include <initializer_list>
#include <optional>

#include <Eigen/Geometry>

#include <pliant/body/points.h>

namespace pliant {

struct JointSetting {
  Point from, to;     ///< the points x_0 and x_1 (hinge, slider, weld: x_0 and y_0)
  double length = 0;  ///< length of a rod or string, m
  /// Direction at `to`, in the frame of the undeformed part of `to` or in the world: the normal of a plane,
  /// the direction of a line or slider, or the pin of a hinge. Any length > 0.
  Vec3<double> axis{0, 0, 1};
  /// Direction of the pin of a hinge at `from`, in the frame of the undeformed part of `from` or in the
  /// world. Default: the direction of `axis` at time 0 with undeformed parts.
  std::optional<Vec3<double>> from_axis{};
  /// For a weld or slider: the orientation of the part of `from` in the frame of the part of `to` while the
  /// joint is closed. A point of the world has the frame of the world. Default: the orientation at time 0.
  std::optional<Eigen::Quaterniond> rotation{};
};

/// A member of JointSetting, besides the points, that a type of joint uses.
enum class JointKey : unsigned { length = 1, axis = 2, from_axis = 4, rotation = 8 };

/// A set of JointKey values.
struct JointKeys {
  unsigned set = 0;
  constexpr JointKeys() = default;
  constexpr JointKeys(std::initializer_list<JointKey> keys) {
    for (const JointKey key : keys) set |= static_cast<unsigned>(key);
  }
  constexpr bool has(JointKey key) const { return (set & static_cast<unsigned>(key)) != 0; }
};

}  // namespace pliant
