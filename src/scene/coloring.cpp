#include <pliant/scene/coloring.h>

#include <algorithm>

namespace pliant {

const std::vector<QuantityInfo>& all_quantities() {
  static const std::vector<QuantityInfo> all{
      {SurfaceQuantity::displacement, "displacement", "m",
       "distance of the surface from its rest position, in the frame of the part"},
      {SurfaceQuantity::strain, "strain", "1", "largest principal Green strain of the surface"}};
  return all;
}

const QuantityInfo& quantity_info(SurfaceQuantity quantity) {
  return all_quantities()[static_cast<std::size_t>(quantity)];
}

std::optional<SurfaceQuantity> find_quantity(const std::string& name) {
  for (const QuantityInfo& info : all_quantities())
    if (name == info.name) return info.quantity;
  return std::nullopt;
}

bool colors(const Coloring& coloring, const Part& part) {
  if (coloring.parts.empty()) return !part.rigid() && !part.fixed();
  return std::find(coloring.parts.begin(), coloring.parts.end(), &part) != coloring.parts.end();
}

}  // namespace pliant
