// A massless rod of length l > 0: the distance of two points is l.
//   C = |x_0 - x_1| - l
// While the two points coincide, the rod has no direction and no force.
#pragma once

#include <array>
#include <limits>

#include <pliant/body/joints/joint_setting.h>
#include <pliant/math/scalar/functions.h>

namespace pliant {

struct Rod {
  static constexpr const char* name = "rod";
  static constexpr const char* formula = "|x_0 - x_1| - length = 0";
  static constexpr JointKeys keys{JointKey::length};
  static constexpr int rows = 1, first = 1, second = 1;
  static constexpr bool one_sided = false;
  double length = 1;  ///< m

  /// Returns a message if the length is invalid, else nullptr.
  const char* fault() const {
    return length > 0 && length < std::numeric_limits<double>::infinity() ? nullptr : "needs a length > 0";
  }

  template <class T>
  Vec<T, rows> C(const std::array<Vec3<T>, first + second>& x, const T& /*t*/) const {
    const Vec3<T> d = x[0] - x[1];
    Vec<T, rows> C;
    C[0] = math::sqrt_from_zero(T(d.dot(d))) - T(length);
    return C;
  }
};

}  // namespace pliant
