// Mass points of a part: a quadrature of its material domain, integral mu (.) du ~ sum m_k (.)(u_k), exact to
// rounding for what the dynamic parameters can do (design 1.3). No mesh. The cheapest of four rules is chosen
// when the part is prepared:
//   affine    4 points carrying mass, centroid and second moments
//   sections  3 such points in each plane section of a solid, times a rule along z
//   rings     3 such points in each of some material rings (u, w) = const
//   full      all of u, v and w
#pragma once

#include <string>
#include <vector>

#include <pliant/math/scalar/pack.h>
#include <pliant/shape/material.h>

namespace pliant {

class Part;

struct MassPoints {
  std::vector<Material<Pack>> at;  ///< four points each; the last may hold points of no mass
  std::vector<Pack> mass;          ///< kg
  int n_points = 0;
  std::string rule;  ///< "affine", "sections", "rings", "full"
  int level = 0;     ///< refinement that sufficed
  /// Relative change of the integrals that doubling still makes; 0 where refinement settled, as it should.
  double unsettled = 0;
};

/// Lays the mass points of a part: of its solid (density in kg/m^3) or of its shell (density in kg/m^2), at
/// rest. Along each direction nodes are doubled until no entry of the mass matrix and of the inertial forces
/// changes by more than 2e-14 of its scale, at states spread over the ranges of the dynamic parameters; then
/// thinned to those that the same integrals need. doublings: that many more, before thinning. Throws
/// std::invalid_argument when the rest shape or the initial one folds over, or more than 2 million points
/// were needed.
MassPoints place_mass_points(const Part& part, int doublings = 0);

}  // namespace pliant
