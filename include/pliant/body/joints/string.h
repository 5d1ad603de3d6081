// An inextensible string of length l > 0: the distance of two points is at most l.
//   C = l - |x_0 - x_1| >= 0
// A taut string pulls; a slack string has no force.
#pragma once

#include <array>

#include <pliant/body/joints/rod.h>

namespace pliant {

struct String {
  static constexpr const char* name = "string";
  static constexpr const char* formula = "length - |x_0 - x_1| >= 0";
  static constexpr JointKeys keys{JointKey::length};
  static constexpr int rows = 1, first = 1, second = 1;
  static constexpr bool one_sided = true;
  double length = 1;  ///< m

  const char* fault() const { return Rod{length}.fault(); }

  template <class T>
  Vec<T, rows> C(const std::array<Vec3<T>, first + second>& x, const T& t) const {
    return -Rod{length}.C(x, t);
  }
};

}  // namespace pliant
