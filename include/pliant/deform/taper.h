// Taper (Barr 1984, physics 2.1): (x (1 + tx zeta), y (1 + ty zeta), z).
#pragma once

#include <pliant/deform/deform.h>

namespace pliant {

struct Taper {
  static constexpr const char* name = "taper";
  static constexpr const char* formula = "(x (1 + tx zeta), y (1 + ty zeta), z)";
  static constexpr std::array<ParameterSpec, 2> parameters{{
      {"tx",
       0,
       {-1, 1},
       {-1, 1},
       false,
       "1",
       "relative growth of x from the middle to zeta = 1",
       Follows::section},
      {"ty",
       0,
       {-1, 1},
       {-1, 1},
       false,
       "1",
       "relative growth of y from the middle to zeta = 1",
       Follows::section},
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
    const T wide = b[0] * zeta + 1.0, deep = b[1] * zeta + 1.0;
    // The tip of a full taper is the pole itself; beside it no place leads back.
    auto back = [](const T& x, const T& by) {
      const T any = math::max(T(math::abs(by) - T(1e-300)), T(math::abs(x) - T(1e-300)));
      return math::where_positive(any, T(x / math::where_positive(any, by, T(1))), T(0));
    };
    return {back(p[0], wide), back(p[1], deep), p[2]};
  }
};

}  // namespace pliant
