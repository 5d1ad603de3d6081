// The superellipse |x|^(2/eps) + |y|^(2/eps) = 1 with unit axes: its moments, its inverse map and its
// quadrature panels, shared by the superquadrics.
#pragma once

#include <utility>

#include <pliant/math/scalar/signed_power.h>
#include <pliant/shape/shape.h>

namespace pliant {

/// superellipse_support() replaces larger exponents by this value, because the dual exponent q is infinite at
/// 2.
inline constexpr double kMaxConvexExponent = 2 - 1e-9;

/// Returns the area and the mean squares of the unit superellipse. With the Beta function B,
///   area = eps B(eps/2, eps/2),   mean square of x or y = (eps/2) B(3 eps/2, eps/2) / area
/// (Jaklic, Leonardis and Solina 2000).
Section superellipse_section(double eps);

/// Returns the cosine C and the sine S of the material angle at which (C^eps, S^eps) points along (x, y). For
/// the origin it returns (1, 0).
std::pair<Trig<double>, Trig<double>> superellipse_label(double x, double y, double eps);

/// Returns (1 - |t|^(2/eps))^(eps/2), the half width of the unit superellipse at height t. gap: 1 - |t|,
/// given separately because 1 - |t| is inaccurate near |t| = 1.
double superellipse_width(double t, double gap, double eps);

/// The point of a plane convex curve that is farthest in a direction, and the value of the support function.
template <class T>
struct PlaneSupport {
  T x, y;  ///< the point
  T h;     ///< x times the first component of the direction, plus y times the second
};

/// Returns the point of the unit superellipse that is farthest in the direction (m, n), m, n >= 0. The
/// support function of the unit ball of a p-norm is the q-norm with 1/p + 1/q = 1, so q = 2 / (2 - eps); the
/// point is the gradient of this function. For eps >= 2 the function uses the convex hull, the square with
/// the corners (1, 0) and (0, 1). The point for m = n is then the middle of a side. For m = n = 0 the result
/// is the point (1, 0).
template <class T>
PlaneSupport<T> superellipse_support(const T& m, const T& n, const T& eps) {
  const T most(kMaxConvexExponent), e = math::min(eps, most), slope = e / T(T(2) - e);  // q - 1
  const T first = m - n;  // if not negative, m is the larger component
  const T big = math::where_positive(-first, n, m), small = math::where_positive(-first, m, n);
  const T ratio = small / math::where_positive(big, big, T(1));
  const T power = power_from_zero(ratio, slope), sum = power * ratio + 1.0;  // (ratio^(q-1), 1 + ratio^q)
  const T of_big = math::exp(T(math::log(sum) * e * -0.5)), of_small = of_big * power;
  return {math::where_positive(-first, of_small, of_big), math::where_positive(-first, of_big, of_small),
          big * sum * of_big};
}

/// Returns the sign of x as a factor: -1 for negative x, else 1.
template <class T>
T sign_factor(const T& x) {
  return math::where_positive(T(-x), T(-1), T(1));
}

/// Returns the panels of a material angle over the whole circle: one periodic panel if eps is frozen at 1,
/// otherwise eight power panels. eps: exponent of the superellipse; dynamic_exponent: whether eps is a degree
/// of freedom.
std::vector<Panel> circle_panels(double eps, bool dynamic_exponent);
/// Returns the panels of a material angle from -pi/2 to pi/2: one smooth panel if eps is frozen at 1,
/// otherwise four power panels.
std::vector<Panel> half_circle_panels(double eps, bool dynamic_exponent);

/// Returns the intervals of zeta = z / h for a shape whose sections have the width
/// superellipse_width(zeta, 1 - |zeta|, eps).
std::vector<SectionPanel> superellipse_section_panels(double eps);

}  // namespace pliant
