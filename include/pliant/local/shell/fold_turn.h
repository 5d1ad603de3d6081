// The term g(dtheta) by which the own coordinate y of a folding hinge exceeds phi (bending.h): phi = y - g.
// The angle dtheta between -pi and pi jumps by 2 pi where a fold passes half a turn. The rotations of the
// mid-edge normal relative to its triangles, dtheta/2 + phi and dtheta/2 - phi, must not jump there, except
// by 2 pi. Therefore phi jumps by pi, and g jumps by -pi, so that y is continuous:
//   g = 0 for |dtheta| <= pi/2,  else g = sgn(dtheta) pi S(t),  t = (|dtheta| - pi/2)/pi,
//   S = t^3 (10 - 15 t + 6 t^2),
// so that g = +-pi/2 for dtheta = +-pi. g' and g'' are continuous, also at half a turn. y records the number
// of turns of a fold: after n turns, y is near n pi.
#pragma once

#include <cmath>

#include <pliant/math/scalar/functions.h>
#include <pliant/math/scalar/pack.h>

namespace pliant {

/// g (rad), g' and g'' (1/rad) of one hinge or of four hinges.
template <class T>
struct FoldTurn {
  T value, slope, curvature;
};

/// Returns g and its derivatives. dtheta: rad, from -pi to pi.
inline FoldTurn<double> fold_turn(double dtheta) {
  const double t = (std::abs(dtheta) - kPi / 2) / kPi;
  if (t <= 0) return {0, 0, 0};
  const double sign = dtheta > 0 ? 1 : -1;
  return {sign * kPi * t * t * t * (10 + t * (6 * t - 15)), 30 * t * t * (1 - t) * (1 - t),
          sign * 60 * t * (1 - t) * (1 - 2 * t) / kPi};
}

/// Adds n whole turns to dtheta and subtracts n half turns from phi, with the n that gives |phi| <= pi/2. The
/// rotations of the mid-edge normal, dtheta/2 + phi and dtheta/2 - phi, change by whole turns only.
inline void remove_turns(double& dtheta, double& phi) {
  if (std::abs(phi) <= kPi / 2) return;
  const double turns = std::round(phi / kPi);
  dtheta += 2 * kPi * turns;
  phi -= kPi * turns;
}

}  // namespace pliant
