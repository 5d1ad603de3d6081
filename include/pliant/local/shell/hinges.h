// Changes since rest of all hinge angles (hinge.h) and strains of all triangles of a mesh, with their
// gradients, in batches of four. Bending (bending.h) uses one of two classes: LinearHinges, linear in the
// displacements, or FoldingHinges, exact in the positions.
#pragma once

#include <array>
#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/edge_strain.h>
#include <pliant/local/shell/fold_turn.h>
#include <pliant/local/shell/hinge.h>

namespace pliant {

/// dtheta (rad) of four hinges, and the terms g of their own coordinates (fold_turn.h).
struct HingeAngles {
  Pack change;
  FoldTurn<Pack> turn;
};

/// Angles and strains linear in the displacements d: dtheta = dtheta/dx(rest) . d. X: positions at rest, m.
class LinearHinges {
 public:
  static constexpr NodalEnergy::Of kOf = NodalEnergy::Of::displacement;
  LinearHinges(const ElementBatches<4>& hinges, const ElementBatches<3>& triangles, const VecX<double>& X);

  /// Returns the angles of four hinges with corner displacements d.
  HingeAngles angles(int batch, const HingeCorners<Pack>& d) const;
  /// Returns the term g of the own coordinates: 0.
  FoldTurn<Pack> turn(int, const HingeCorners<Pack>&) const { return {0.0, 0.0, 0.0}; }
  /// Returns the gradient of dtheta, 1/m.
  const HingeCorners<Pack>& gradient(int batch, const HingeCorners<Pack>&) const {
    return gradients_[static_cast<std::size_t>(batch)];
  }
  /// Returns q of four triangles (edge_strain.h), m^2.
  std::array<Pack, 3> strain(int batch, const std::array<Vec3<Pack>, 3>& d) const {
    return strain_change(edges(batch, d), edges_of(d));
  }
  /// Returns the edges e_k, m. The tension tau_k = dW/dq_k (edge_strain.h) acts along e_k.
  const Edges<Pack>& edges(int batch, const std::array<Vec3<Pack>, 3>&) const {
    return edges_[static_cast<std::size_t>(batch)];
  }

 private:
  std::vector<HingeCorners<Pack>> gradients_;
  std::vector<Edges<Pack>> edges_;
};

/// Exact changes of angles and strains from rest to the positions x. dtheta is between -pi and pi. turn()
/// returns the term of the own coordinate by which a fold can pass half a turn. The other members are those
/// of LinearHinges, with x in place of d; edges() returns the current edges.
class FoldingHinges {
 public:
  static constexpr NodalEnergy::Of kOf = NodalEnergy::Of::position;
  FoldingHinges(const ElementBatches<4>& hinges, const ElementBatches<3>& triangles, const VecX<double>& X);

  HingeAngles angles(int batch, const HingeCorners<Pack>& x) const;
  FoldTurn<Pack> turn(int batch, const HingeCorners<Pack>& x) const;
  HingeCorners<Pack> gradient(int, const HingeCorners<Pack>& x) const { return hinge_gradient(x); }
  std::array<Pack, 3> strain(int batch, const std::array<Vec3<Pack>, 3>& x) const;
  Edges<Pack> edges(int, const std::array<Vec3<Pack>, 3>& x) const { return edges_of(x); }

 private:
  /// Returns g of four hinges from the sine and cosine of dtheta.
  static FoldTurn<Pack> turn(const math::SinCos<Pack>& change);
  /// Returns the sine and cosine of dtheta, both multiplied by a positive number.
  math::SinCos<Pack> change(int batch, const HingeCorners<Pack>& x) const;

  std::vector<math::SinCos<Pack>> rest_;  // sine and cosine of theta at rest, as hinge_sin_cos returns them
  std::vector<std::array<Pack, 3>> rest_strain_;  // |e_k|^2/2 at rest, m^2
};

}  // namespace pliant
