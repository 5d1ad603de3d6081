// Function bodies of shell_edges.h.
#pragma once

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include <pliant/local/shell/shell_edges.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE std::vector<ShellEdge> shell_edges(const ShellMesh& mesh) {
  std::vector<ShellEdge> edges;
  std::map<std::pair<int, int>, std::size_t> known;
  for (int t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles()((k + 1) % 3, t), b = mesh.triangles()((k + 2) % 3, t);
      const auto [at, is_new] = known.try_emplace(std::minmax(a, b), edges.size());
      if (is_new) {
        edges.push_back({a, b, t, k, -1, -1});
        continue;
      }
      ShellEdge& edge = edges[at->second];
      const std::string name = "the edge between nodes " + std::to_string(a) + " and " + std::to_string(b);
      if (edge.inside()) throw std::invalid_argument(name + " has more than two triangles");
      if (edge.a == a)
        throw std::invalid_argument(name +
                                    " has two triangles of opposite orientation; corners must run "
                                    "counter-clockwise seen from outside");
      edge.right = t;
      edge.right_corner = k;
    }
  std::stable_partition(edges.begin(), edges.end(), [](const ShellEdge& edge) { return edge.inside(); });
  return edges;
}

}  // namespace pliant
