// Function bodies of hinges.h.
#pragma once

#include <array>
#include <cmath>

#include <pliant/local/shell/hinges.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE LinearHinges::LinearHinges(const ElementBatches<4>& hinges, const ElementBatches<3>& triangles,
                                         const VecX<double>& X) {
  for (int b = 0; b < hinges.n_batches(); ++b) gradients_.push_back(hinge_gradient(hinges.corners(X, b)));
  for (int b = 0; b < triangles.n_batches(); ++b) edges_.push_back(edges_of(triangles.corners(X, b)));
}

PLIANT_INLINE HingeAngles LinearHinges::angles(int batch, const HingeCorners<Pack>& d) const {
  return {dot(gradients_[static_cast<std::size_t>(batch)], d), turn(batch, d)};
}

PLIANT_INLINE FoldingHinges::FoldingHinges(const ElementBatches<4>& hinges,
                                           const ElementBatches<3>& triangles, const VecX<double>& X) {
  for (int b = 0; b < hinges.n_batches(); ++b) rest_.push_back(hinge_sin_cos(hinges.corners(X, b)));
  for (int b = 0; b < triangles.n_batches(); ++b)
    rest_strain_.push_back(half_squares(edges_of(triangles.corners(X, b))));
}

PLIANT_INLINE std::array<Pack, 3> FoldingHinges::strain(int batch, const std::array<Vec3<Pack>, 3>& x) const {
  std::array<Pack, 3> q = half_squares(edges_of(x));
  for (std::size_t k = 0; k < 3; ++k) q[k] -= rest_strain_[static_cast<std::size_t>(batch)][k];
  return q;
}

PLIANT_INLINE math::SinCos<Pack> FoldingHinges::change(int batch, const HingeCorners<Pack>& x) const {
  const math::SinCos<Pack>& rest = rest_[static_cast<std::size_t>(batch)];
  const math::SinCos<Pack> now = hinge_sin_cos(x);
  return {now.sin * rest.cos - now.cos * rest.sin, now.cos * rest.cos + now.sin * rest.sin};
}

PLIANT_INLINE FoldTurn<Pack> FoldingHinges::turn(const math::SinCos<Pack>& change) {
  const auto& [s, c] = change;
  FoldTurn<Pack> turn{0.0, 0.0, 0.0};
  if (c[0] >= 0 && c[1] >= 0 && c[2] >= 0 && c[3] >= 0) return turn;  // no fold of more than a right angle
  for (int lane = 0; lane < Pack::kLanes; ++lane) {
    const FoldTurn<double> one = fold_turn(std::atan2(s[lane], c[lane]));
    turn.value.set(lane, one.value);
    turn.slope.set(lane, one.slope);
    turn.curvature.set(lane, one.curvature);
  }
  return turn;
}

PLIANT_INLINE HingeAngles FoldingHinges::angles(int batch, const HingeCorners<Pack>& x) const {
  const math::SinCos<Pack> of = change(batch, x);
  const auto& [s, c] = of;
  return {{std::atan2(s[0], c[0]), std::atan2(s[1], c[1]), std::atan2(s[2], c[2]), std::atan2(s[3], c[3])},
          turn(of)};
}

PLIANT_INLINE FoldTurn<Pack> FoldingHinges::turn(int batch, const HingeCorners<Pack>& x) const {
  return turn(change(batch, x));
}

}  // namespace pliant
