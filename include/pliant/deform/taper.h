// Taper (Barr 1984): (x (1 + tx zeta), y (1 + ty zeta), z), zeta = z / h.
#pragma once

#include <pliant/deform/deform.h>

namespace pliant {

struct Taper {
  static constexpr const char* name = "taper";
  static constexpr const char* formula = "(x (1 + tx zeta), y (1 + ty zeta), z)";
  static constexpr std::array<ParameterSpec, 2> parameters{{
      ratio("tx", 0, {-1, 1}, {-1, 1}, "relative growth of x from the middle to zeta = 1", Follows::section),
      ratio("ty", 0, {-1, 1}, {-1, 1}, "relative growth of y from the middle to zeta = 1", Follows::section),
  }};
  static constexpr Sections sections = Sections::stay_plane;

  template <class T>
  static Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, 2>& b) {
    const T zeta = p[2] / h;
    return {p[0] * (b[0] * zeta + 1.0), p[1] * (b[1] * zeta + 1.0), p[2]};
  }
  template <class T>
  static Vec3<T> inverse(const Vec3<T>& p, const T& h, const Vec<T, 2>& b) {
    const T zeta = p[2] / h;
    return {p[0] / bounded_width(T(b[0] * zeta + 1.0)), p[1] / bounded_width(T(b[1] * zeta + 1.0)), p[2]};
  }

 private:
  /// Returns width, or 1e-10 if |width| <= 1e-10. width: factor of the section relative to the middle
  /// section. The width is zero at the tip of a full taper (|tx| or |ty| = 1); with the bound, the inverse
  /// maps the tip to the axis.
  template <class T>
  static T bounded_width(const T& width) {
    const T min_width(1e-10);
    return math::where_positive(T(math::abs(width) - min_width), width, min_width);
  }
};

}  // namespace pliant
