// Pieces of a material angle, or of a section coordinate, on which a shape is smooth: quadrature never
// crosses a kink.
#pragma once

#include <vector>

namespace pliant {

/// A piece of an angle (u or v).
struct Panel {
  enum class Kind {
    smooth,    ///< analytic between two angles, ends included
    periodic,  ///< analytic and periodic on the whole circle
    power,     ///< half a quadrant, next to an axis, where e varies as |sin|^eps or |cos|^eps
  };
  Kind kind;
  double from = 0, to = 0;         ///< angles of a smooth panel, rad
  int sign_cos = 1, sign_sin = 1;  ///< quadrant of a power panel
  bool along_sin = true;           ///< power panel: next to sin = 0 (else next to cos = 0)
  double eps = 1;                  ///< power panel: exponent
};

/// The quadrant panels of an exponent: smooth for eps = 1 where the caller says so by using another panel.
inline void add_power_quadrant(std::vector<Panel>& panels, int sign_cos, int sign_sin, double eps) {
  for (bool along_sin : {true, false})
    panels.push_back({Panel::Kind::power, 0, 0, sign_cos, sign_sin, along_sin, eps});
}

/// A piece of zeta = z / h.
struct SectionPanel {
  double from, to;
  bool singular;  ///< algebraic singularities at the ends (tanh-sinh), else analytic (Gauss)
};

}  // namespace pliant
