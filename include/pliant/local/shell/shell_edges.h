// Edges of a triangle mesh and the triangles on their two sides.
#pragma once

#include <vector>

#include <pliant/local/shell/shell_mesh.h>

namespace pliant {

/// An edge from node a to node b. In the corner order of the left triangle the edge runs from a to b, in that
/// of the right triangle from b to a.
struct ShellEdge {
  int a, b;
  int left, left_corner;    ///< left triangle, and number (0 to 2) of its corner opposite the edge
  int right, right_corner;  ///< right triangle and its corner; both -1 on the boundary of the mesh
  /// Returns whether the edge has two triangles.
  bool inside() const { return right >= 0; }
};

/// Returns all edges in the order of the triangles; edges between two triangles come before boundary edges.
/// Throws std::invalid_argument if an edge has more than two triangles, or two triangles of opposite
/// orientation. The message gives the nodes of the edge.
std::vector<ShellEdge> shell_edges(const ShellMesh& mesh);

}  // namespace pliant
