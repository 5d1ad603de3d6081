// Function bodies of superellipse.h.
#pragma once

#include <pliant/shape/superellipse.h>

#include <algorithm>
#include <cmath>

#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// Returns the Beta function B(x, y).
inline double beta_function(double x, double y) {
  return std::tgamma(x) * std::tgamma(y) / std::tgamma(x + y);
}

}  // namespace detail

PLIANT_INLINE Section superellipse_section(double eps) {
  const double area = eps * detail::beta_function(eps / 2, eps / 2);
  const double square = eps / 2 * detail::beta_function(1.5 * eps, eps / 2) / area;
  return {area, square, square};
}

PLIANT_INLINE std::pair<Trig<double>, Trig<double>> superellipse_label(double x, double y, double eps) {
  const double ax = std::abs(x), ay = std::abs(y), big = std::max(ax, ay);
  if (big == 0) return {trig(1.0), trig(0.0)};
  // Computed with logarithms, so that small exponents cause no underflow.
  const double lx = ax > 0 ? std::log(ax / big) / eps : kLogZero,
               ly = ay > 0 ? std::log(ay / big) / eps : kLogZero;
  const double log_size = 0.5 * std::log(std::exp(2 * lx) + std::exp(2 * ly));
  auto side = [&](double value, double log_value) {
    return value == 0 ? trig(0.0) : trig_from_log(log_value - log_size, value > 0 ? 1.0 : -1.0);
  };
  return {side(x, lx), side(y, ly)};
}

PLIANT_INLINE double superellipse_width(double t, double gap, double eps) {
  const double a = std::abs(t);
  if (a == 0) return 1;
  // 1 - a^(2/eps) = -expm1((2/eps) log a). Near a = 1, log a = log1p(-gap) is accurate.
  const double log_a = gap < 0.5 ? std::log1p(-gap) : std::log(a);
  return std::pow(-std::expm1(2 / eps * log_a), eps / 2);
}

PLIANT_INLINE std::vector<Panel> circle_panels(double eps, bool dynamic_exponent) {
  if (eps == 1 && !dynamic_exponent) return {{Panel::Kind::periodic, 0, 2 * kPi}};
  std::vector<Panel> panels;
  for (int c : {1, -1})
    for (int s : {1, -1}) add_power_quadrant(panels, c, s, eps);
  return panels;
}

PLIANT_INLINE std::vector<Panel> half_circle_panels(double eps, bool dynamic_exponent) {
  if (eps == 1 && !dynamic_exponent) return {{Panel::Kind::smooth, -kPi / 2, kPi / 2}};
  std::vector<Panel> panels;
  for (int s : {-1, 1}) add_power_quadrant(panels, 1, s, eps);
  return panels;
}

PLIANT_INLINE std::vector<SectionPanel> superellipse_section_panels(double eps) {
  if (eps == 1) return {{-1, 1, false}};
  const bool singular = eps != 2;
  return {{-1, 0, singular}, {0, 1, singular}};
}

}  // namespace pliant
