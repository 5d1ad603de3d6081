// Mass points of a part: a quadrature of its material domain for the sums of Eq. (11),
//   integral mu f du = sum m_k f(u_k),   mu: mass density, u_k: material points.
// The quadrature is exact to rounding for all values of the dynamic parameters within their ranges, and needs
// no mesh. Part::prepare() uses the cheapest of four rules:
//   affine    4 points that have the mass, the centroid and the second moments of the part
//   sections  3 points in each of some plane sections z = const of a solid
//   rings     3 points in each of some material rings (u, w) = const
//   full      points along u, v and w
// include/pliant/part/quadrature/README.md explains when each rule applies.
#pragma once

#include <string>
#include <vector>

#include <pliant/math/scalar/pack.h>
#include <pliant/shape/material.h>

namespace pliant {

class Part;

struct MassPoints {
  std::vector<Material<Pack>> at;  ///< in packs of four; unused lanes of the last pack have mass 0
  std::vector<Pack> mass;          ///< kg
  int n_points = 0;
  std::string rule;  ///< "affine", "sections", "rings", "full"
  int level = 0;     ///< level of refinement at which the search along the last direction (z or u) stopped
  /// Relative change of the integrals when the nodes along a direction are doubled once more. The value is 0
  /// if this change is at most 2e-14, or if it is at most 1e-12 and finer rules do not halve it. With a mass
  /// distribution, mass, centre and second moments are compared with those of an independent grid
  /// (body_points.h). If their difference is above 1e-7, the value is at least this difference.
  double relative_error = 0;
};

/// Returns the mass points of a part at rest, with the masses of Part::density() and
/// Part::mass_distribution(). Along each direction, the number of quadrature nodes is increased until
/// doubling changes no test integral by more than 2e-14 of its scale. A change of at most 1e-12 is accepted
/// if finer rules do not halve it. The test integrals are random combinations of the entries of M and g_q, at
/// states spread over the ranges of the dynamic parameters. Then nodes that the integrals do not need are
/// removed. doublings: number of further doublings before this removal. Throws std::invalid_argument if the
/// rest or the initial shape folds over, or if a rule other than "sections" needs more than 2 million points.
MassPoints place_mass_points(const Part& part, int doublings = 0);

/// Returns the volume of a solid (m^3) or the area of a shell (m^2) at rest.
double volume_at_rest(const Part& part);

}  // namespace pliant
