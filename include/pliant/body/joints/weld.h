// A weld: two frames coincide.
//   C = (x_0 - y_0, size times the rotation vector of b^T a),   a and b the frames at x_0 and y_0
#pragma once

#include <array>

#include <pliant/body/joint_setting.h>
#include <pliant/body/material_frame.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

struct Weld {
  static constexpr const char* name = "weld";
  static constexpr const char* formula = "x_0 - x_1 = 0, and no turning";
  static constexpr JointKeys keys{JointKey::rotation};
  static constexpr int rows = 6, first = MaterialFrame::points, second = MaterialFrame::points;
  static constexpr bool one_sided = false;
  MaterialFrame from, to;
  double size = 1;  ///< m, makes angles lengths

  template <class T>
  Vec<T, rows> C(const std::array<Vec3<T>, first + second>& x, const T& /*t*/) const {
    Vec<T, rows> C;
    C.template head<3>() = x[0] - x[first];
    const Mat3<T> turn = to.at(&x[first]).transpose() * from.at(&x[0]);
    C.template tail<3>() = rotation_vector(turn) * T(size);
    return C;
  }
};

}  // namespace pliant
