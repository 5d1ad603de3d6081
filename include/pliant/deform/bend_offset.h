// The bend of Metaxas and Terzopoulos 1993, reference [7] of the paper: a lateral offset along x,
//   (x + b1 cos(pi b3 (zeta + b2)), y, z)
// It does not preserve the length of the axis. Use it for small bends only. zeta = z / h, h: half height.
#pragma once

#include <pliant/deform/deform.h>

namespace pliant {

struct BendOffset {
  static constexpr const char* name = "bend_offset";
  static constexpr const char* formula = "(x + b1 cos(pi b3 (zeta + b2)), y, z)";
  static constexpr std::array<ParameterSpec, 3> parameters{{
      displacement("b1", "largest offset", Follows::section),
      ratio("b2", 0, {-1, 1}, {-1, 1}, "the offset is largest at zeta = -b2", Follows::section),
      ratio("b3", 1, {1e-3, 1}, {1e-3, 1}, "periods of the cosine over the length of the axis",
            Follows::section),
  }};
  static constexpr Sections sections = Sections::stay_plane;
  static constexpr int amplitudes = 1;

  template <class T>
  static Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, 3>& b) {
    return {p[0] + offset(p[2], h, b), p[1], p[2]};
  }
  template <class T>
  static Vec3<T> inverse(const Vec3<T>& p, const T& h, const Vec<T, 3>& b) {
    return {p[0] - offset(p[2], h, b), p[1], p[2]};
  }

 private:
  template <class T>
  static T offset(const T& z, const T& h, const Vec<T, 3>& b) {
    return b[0] * math::cos(T((z / h + b[1]) * b[2] * kPi));
  }
};

}  // namespace pliant
