// The point-to-point joint of the paper: two points coincide,
//   C = x_0 - x_1.
// With a moving point of the world, the other point follows a prescribed path.
#pragma once

#include <array>

#include <pliant/body/joints/joint_setting.h>

namespace pliant {

struct Ball {
  static constexpr const char* name = "ball";
  static constexpr const char* formula = "x_0 - x_1 = 0";
  static constexpr JointKeys keys{};
  static constexpr int rows = 3, first = 1, second = 1;
  static constexpr bool one_sided = false, linear = true;

  template <class T>
  Vec<T, rows> C(const std::array<Vec3<T>, first + second>& x, const T& /*t*/) const {
    return x[0] - x[1];
  }
};

}  // namespace pliant
