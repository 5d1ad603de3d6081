// The edges of a triangle mesh: which two triangles meet at each.
#pragma once

#include <vector>

#include <pliant/local/shell/shell_mesh.h>

namespace pliant {

/// From node a to node b, as the triangle on its left runs; the other triangle runs from b to a.
struct ShellEdge {
  int a, b;
  int left, left_corner;    ///< a triangle, and its corner opposite the edge
  int right, right_corner;  ///< -1 on the boundary of the mesh
  bool inside() const { return right >= 0; }
};

/// All edges in the order of the triangles, those between two triangles before those of the boundary.
/// Throws std::invalid_argument when an edge has more than two triangles, or two that do not run the same way
/// round; the message names the nodes.
std::vector<ShellEdge> shell_edges(const ShellMesh& mesh);

}  // namespace pliant
