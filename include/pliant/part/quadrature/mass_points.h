// Mass points of a part: a quadrature of its material domain, integral mu f du ~ sum m_k f(u_k), for the sums
// of Eq. (11). The quadrature is exact to rounding for all values of the dynamic parameters within their
// ranges, and needs no mesh. Part::prepare() uses the cheapest of four rules:
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
  std::vector<Material<Pack>> at;  ///< in packs of four; the last pack may have points without mass
  std::vector<Pack> mass;          ///< kg
  int n_points = 0;
  std::string rule;  ///< "affine", "sections", "rings", "full"
  int level = 0;     ///< level of refinement at which the search along its last direction (z or u) stopped
  /// Relative change of the integrals by doubling the points once more. 0 if the change is at most 2e-14, or
  /// if it is at most 1e-12 and finer rules do not halve it.
  double relative_error = 0;
};

/// Returns the mass points of a part at rest: of a solid (density in kg/m^3) or of a shell (density in
/// kg/m^2). Along each direction, the number of quadrature nodes is doubled until no test integral changes by
/// more than 2e-14 of its scale (1e-12 where terms cancel). The test integrals are random combinations of the
/// entries of M and g_q, at states spread over the ranges of the dynamic parameters. Then nodes that the
/// integrals do not need are removed. doublings: number of further doublings before this removal. Throws
/// std::invalid_argument if the rest or the initial shape folds over, or if more than 2 million points are
/// needed.
MassPoints place_mass_points(const Part& part, int doublings = 0);

}  // namespace pliant
