// Material points in packs of four, the input of the kernels.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <pliant/math/scalar/pack.h>
#include <pliant/shape/material.h>

namespace pliant {

/// Returns the material points number `first` to `first` + 3 as one pack. Lanes beyond the last point repeat
/// this point.
inline Material<Pack> pack_at(const std::vector<Material<double>>& points, std::size_t first) {
  std::array<Material<double>, Pack::kLanes> four;
  for (std::size_t i = 0; i < Pack::kLanes; ++i) four[i] = points[std::min(first + i, points.size() - 1)];
  return gather(four.data());
}

/// Returns all material points in packs of four. Unused lanes of the last pack repeat the last point.
inline std::vector<Material<Pack>> packs_of(const std::vector<Material<double>>& points) {
  std::vector<Material<Pack>> packs;
  for (std::size_t first = 0; first < points.size(); first += Pack::kLanes)
    packs.push_back(pack_at(points, first));
  return packs;
}

}  // namespace pliant
