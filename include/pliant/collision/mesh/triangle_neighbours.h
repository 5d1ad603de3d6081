// The triangles on both sides of each edge of a mesh whose solids may touch, and the separation of these
// solids. Where solids touch along an edge, the edge has two or more pairs of triangles. The two triangles of
// a pair bound one solid: a turn about the edge, from the first triangle into its solid, reaches the second
// triangle before any other one.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include <pliant/math/types.h>

namespace pliant {

/// A triangle is treated as one without area if its height is at most this share of its longest edge. The
/// share allows for files that store vertices in single precision.
inline constexpr double kNoHeight = 1e-7;

struct TriangleNeighbours {
  /// kBorder: the edge has no other triangle. kConflict: the triangles of the edge do not form pairs.
  static constexpr int kBorder = -1, kConflict = -2;

  /// Element t has the three triangles across the edges of triangle t: between its corners 0 and 1, 1 and 2,
  /// 2 and 0.
  std::vector<std::array<int, 3>> across;
  int touching_edges = 0;  ///< number of edges with more than one pair

  /// x: vertices, no two of which are equal. triangles: vertex numbers, three different ones per triangle.
  TriangleNeighbours(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles);
};

/// Gives each solid its own copy of the vertices in which it touches other solids or itself. Triangles that
/// are connected by pairs keep common vertices, and so do all triangles of an edge in conflict. Copies are
/// appended to x. A mesh without such vertices does not change.
void separate_touching(Eigen::Matrix3Xd& x, Eigen::Matrix3Xi& triangles);

}  // namespace pliant
