// Quantities by which pictures colour a deformed part, and the setting of a scene that selects one.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// A number at each vertex of a part's surface. Rigid motion of the part changes neither quantity.
enum class SurfaceQuantity {
  displacement,  ///< |p - X|, m: distance of the position p of the vertex from its rest position X, both in
                 ///< the frame of the part; global parameters and local deformation d contribute
  strain,        ///< largest principal Green strain of the surface relative to rest (SurfaceStrain)
};

struct QuantityInfo {
  SurfaceQuantity quantity;
  const char* name;
  const char* unit;  ///< "1" for a dimensionless number
  const char* meaning;
};
/// All quantities, in the order of SurfaceQuantity.
const std::vector<QuantityInfo>& all_quantities();
const QuantityInfo& quantity_info(SurfaceQuantity quantity);
/// Returns the quantity with this name, or std::nullopt if there is none.
std::optional<SurfaceQuantity> find_quantity(const std::string& name);

struct Coloring {
  SurfaceQuantity by = SurfaceQuantity::strain;
  /// Values of the first and the last colour; values outside the range get the nearer of these two colours.
  /// When absent, the range is from 0 to the highest value, rounded up to a round number; [0, 1] if the
  /// highest value is only rounding error. In each recorded state, the 99th percentile of the values at the
  /// vertices of all coloured parts is computed. The highest value is the largest of these percentiles.
  std::optional<std::array<double, 2>> range;
  std::vector<const Part*> parts;  ///< coloured parts; empty: all parts that deform
};

/// Returns whether the setting colours this part.
bool colors(const Coloring& coloring, const Part& part);

}  // namespace pliant
