// Circular bend (Barr 1984): the z axis becomes an arc of curvature k = angle / h in the plane that contains
// z and (cos direction, sin direction, 0). With r the coordinate along this direction and g = k z,
//   r' = r cos g + (1 - cos g) / k,   z' = (sin g) / k - r sin g
// The code uses sinc, so that k = 0 is a regular value. The determinant of the map is 1 - k r.
#pragma once

#include <pliant/deform/deform.h>
#include <pliant/math/scalar/sinc.h>

namespace pliant {

struct Bend {
  static constexpr const char* name = "bend";
  static constexpr const char* formula =
      "r -> r cos g + (1 - cos g)/k, z -> sin(g)/k - r sin g; g = k z, k = angle/h, r along direction";
  static constexpr std::array<ParameterSpec, 2> parameters{{
      angle("angle", {-kPi, kPi}, {-3.1, 3.1}, "turn of the axis between zeta = 0 and zeta = 1",
            Follows::section),
      angle("direction", {-6.3, 6.3}, {-6.3, 6.3},
            "azimuth towards which the axis bends, measured from x towards y", Follows::section),
  }};
  static constexpr Sections sections = Sections::tilt;
  static constexpr int amplitudes = 1;

  template <class T>
  static math::SinCos<T> prepare(const Vec<T, 2>& b) {
    return math::sin_cos(b[1]);
  }
  template <class T>
  static Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, 2>& b) {
    return apply<T>(p, h, b, prepare<T>(b));
  }
  template <class T>
  static Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, 2>& b, const math::SinCos<T>& direction) {
    const auto& [s, c] = direction;
    const T r = c * p[0] + s * p[1];
    const T half = b[0] * p[2] / h * 0.5;  // g / 2
    const math::SinCos<T> sin_cos_half = math::sin_cos(half);
    const auto& [sin_half, cos_half] = sin_cos_half;
    const T sinc_half = sinc(half, sin_cos_half);
    // (1 - cos g)/k = z sinc(g/2) sin(g/2),  sin(g)/k = z sinc(g/2) cos(g/2),  1 - cos g = 2 sin^2(g/2)
    const T reach = p[2] * sinc_half;
    const T shift = reach * sin_half - r * sin_half * sin_half * 2.0;
    return {p[0] + c * shift, p[1] + s * shift, reach * cos_half - r * sin_half * cos_half * 2.0};
  }
  template <class T>
  static Vec3<T> inverse(const Vec3<T>& p, const T& h, const Vec<T, 2>& b) {
    const auto [s, c] = math::sin_cos(b[1]);
    const T k = b[0] / h;
    const T r_bent = c * p[0] + s * p[1];
    // The centre of curvature is at r = 1/k. Let q = k z' and d = 1 - k r'. Then g = atan2(q, d), and
    // rho = sqrt(q^2 + d^2) is 1 - k r (for k r < 1).
    const T q = k * p[2], d = -(k * r_bent) + 1.0;
    const T rho = math::sqrt(T(q * q + d * d));
    const T gap = k * (r_bent * r_bent + p[2] * p[2]) - r_bent * 2.0;  // (rho^2 - 1) / k
    const T r = -gap / (rho + 1.0);                                    // (1 - rho) / k
    // g = 2 atan(q / (rho + d)). Beyond a quarter turn (d < 0) the code uses the equal expression
    // g = +-pi - 2 atan(q / (rho - d)), with the sign of q.
    const T reach = rho + math::abs(d) + 1e-300;
    const T half_tan = q / reach, half_angle = atan_over(half_tan);
    const T turned = math::where_positive(q, T(kPi), T(-kPi));
    const T back = math::where_positive(d, T(1), k);
    const T z = math::where_positive(d, T(p[2] * half_angle * 2.0 / reach),
                                     T((turned - half_tan * half_angle * 2.0) / back));  // g / k
    const T shift = r - r_bent;
    return {p[0] + c * shift, p[1] + s * shift, z};
  }
};

}  // namespace pliant
