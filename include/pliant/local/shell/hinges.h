// What bending knows of the hinges (hinge.h) and triangles of a mesh: changes of angles and strains since
// rest, and along what they push. Either linear in displacements about rest, or of positions wherever they
// are.
#pragma once

#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/edge_strain.h>
#include <pliant/local/shell/hinge.h>

namespace pliant {

/// Angles and strains that are linear in the displacements: dtheta = dtheta/dx(rest) . d.
class LinearHinges {
 public:
  static constexpr NodalEnergy::Of kOf = NodalEnergy::Of::displacement;
  LinearHinges(const ElementBatches<4>& hinges, const ElementBatches<3>& triangles, const VecX<double>& X);

  Pack angle(int batch, const HingeCorners<Pack>& d) const;
  const HingeCorners<Pack>& gradient(int batch, const HingeCorners<Pack>&) const {
    return gradients_[static_cast<std::size_t>(batch)];
  }
  std::array<Pack, 3> strain(int batch, const std::array<Vec3<Pack>, 3>& d) const {
    return strain_change(edges(batch, d), edges_of(d));
  }
  const Edges<Pack>& edges(int batch, const std::array<Vec3<Pack>, 3>&) const {
    return edges_[static_cast<std::size_t>(batch)];
  }

 private:
  std::vector<HingeCorners<Pack>> gradients_;
  std::vector<Edges<Pack>> edges_;
};

/// Angles and strains of the positions as they are, less those at rest.
class FoldingHinges {
 public:
  static constexpr NodalEnergy::Of kOf = NodalEnergy::Of::position;
  FoldingHinges(const ElementBatches<4>& hinges, const ElementBatches<3>& triangles, const VecX<double>& X);

  Pack angle(int batch, const HingeCorners<Pack>& x) const;
  HingeCorners<Pack> gradient(int, const HingeCorners<Pack>& x) const { return hinge_gradient(x); }
  std::array<Pack, 3> strain(int batch, const std::array<Vec3<Pack>, 3>& x) const;
  Edges<Pack> edges(int, const std::array<Vec3<Pack>, 3>& x) const { return edges_of(x); }

 private:
  std::vector<math::SinCos<Pack>> rest_;
  std::vector<std::array<Pack, 3>> rest_strain_;
};

}  // namespace pliant
