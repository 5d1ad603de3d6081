// Intervals of a material angle, or of zeta = z / h (h: half height), on which a shape is smooth. Each
// quadrature rule covers one interval, so that no rule crosses a kink.
#pragma once

#include <vector>

#include <pliant/math/scalar/functions.h>

namespace pliant {

/// An interval of an angle (u or v).
struct Panel {
  enum class Kind {
    smooth,    ///< analytic between two angles, ends included
    periodic,  ///< analytic and periodic on the whole circle
    power,     ///< 45 degrees that start where sin = 0 (or cos = 0); e varies as |sin|^eps (or |cos|^eps)
  };
  Kind kind;
  double from = 0, to = 0;         ///< smooth and periodic panels: angles at the ends, rad
  int sign_cos = 1, sign_sin = 1;  ///< power panel: signs of cos and sin on the panel
  bool along_sin = true;           ///< power panel: whether it starts where sin = 0 (else cos = 0)
  double eps = 1;                  ///< power panel: exponent
};

/// Adds the two power panels of one quadrant for an exponent eps. sign_cos, sign_sin: signs of cos and sin in
/// the quadrant.
inline void add_power_quadrant(std::vector<Panel>& panels, int sign_cos, int sign_sin, double eps) {
  for (bool along_sin : {true, false})
    panels.push_back({Panel::Kind::power, 0, 0, sign_cos, sign_sin, along_sin, eps});
}

/// An interval of zeta = z / h.
struct SectionPanel {
  double from, to;
  /// Whether the section has algebraic singularities at the ends of the interval; the rule is then
  /// both_ends_rule(), otherwise gauss_rule() (both in math/quadrature.h).
  bool singular;
};

namespace detail {

/// Latitudes (rad) of the rims of a cylinder and of the poles.
inline constexpr double kRimAngle = kPi / 4, kPoleAngle = kPi / 2;

/// Returns the panels along u of shapes with rims at |u| = pi/4.
inline std::vector<Panel> rimmed_profile() {
  using K = Panel::Kind;
  return {{K::smooth, -kPoleAngle, -kRimAngle},
          {K::smooth, -kRimAngle, kRimAngle},
          {K::smooth, kRimAngle, kPoleAngle}};
}
/// Returns the one panel along v of shapes with elliptic sections.
inline std::vector<Panel> round_ring() {
  return {{Panel::Kind::periodic, 0, 2 * kPi}};
}

}  // namespace detail

}  // namespace pliant
