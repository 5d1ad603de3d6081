// Colouring parts in pictures by how they are deformed.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// A number at each vertex of a part's surface. Moving and turning as a rigid body changes neither.
enum class SurfaceQuantity {
  displacement,  ///< |p - X|, m: from where the vertex is at rest, in the part's frame; d and global
                 ///< parameters
  strain,        ///< the largest principal Green strain of the surface, from rest to now (SurfaceStrain)
};

struct QuantityInfo {
  SurfaceQuantity quantity;
  const char* name;
  const char* unit;  ///< "1" for a plain number
  const char* meaning;
};
const std::vector<QuantityInfo>& all_quantities();
const QuantityInfo& quantity_info(SurfaceQuantity quantity);
/// Nothing when no quantity is called so.
std::optional<SurfaceQuantity> find_quantity(const std::string& name);

struct Coloring {
  SurfaceQuantity by = SurfaceQuantity::strain;
  /// Values with the first and the last colour; beyond, colours stay. Where not given it goes from 0 to what
  /// 99 of 100 vertices stay below in the whole recorded motion, rounded up.
  std::optional<std::array<double, 2>> range;
  std::vector<const Part*> parts;  ///< which; empty: those that deform
};

/// Whether a part is coloured by its values.
bool colors(const Coloring& coloring, const Part& part);

}  // namespace pliant
