// An immobile triangle mesh for contact search. The constructor checks the mesh, merges equal vertices, finds
// the edges and the flat faces, and builds a tree of boxes.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <pliant/math/index.h>
#include <pliant/math/types.h>

namespace pliant {

class ObstacleMesh {
 public:
  /// vertices: m, world. triangles: vertex numbers, counter-clockwise seen from the free side. A part that
  /// comes from the other side of a triangle passes through it. Throws std::invalid_argument for a mesh
  /// without triangles, a vertex that is not finite or in no triangle, a triangle with an unknown vertex or
  /// without area, and an edge with three triangles or with two triangles of opposite orientation. The
  /// message names the element and its position.
  ObstacleMesh(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles);

  struct Edge {
    std::array<int, 2> vertex;    ///< triangle[0] is on the left of the line from vertex[0] to vertex[1]
    std::array<int, 2> triangle;  ///< the second one is -1 at the border of an open mesh
    bool sharp;  ///< whether a part outside both faces can touch it: a convex edge or the border
  };
  /// A set of connected triangles in one plane: a point of the plane (m, world) and its unit normal.
  struct Face {
    Vec3<double> point, normal;
  };

  const Eigen::Matrix3Xd& vertices() const { return x_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  const std::vector<Edge>& edges() const { return edges_; }
  /// Returns the edges of a triangle between its corners 0 and 1, 1 and 2, 2 and 0.
  const std::array<int, 3>& edges_of(int triangle) const { return edges_of_[at(triangle)]; }
  Vec3<double> normal(int triangle) const { return normals_.col(triangle); }
  /// Returns the unit vector along an edge, from vertex[0] to vertex[1].
  Vec3<double> along(const Edge& edge) const {
    return (x_.col(edge.vertex[1]) - x_.col(edge.vertex[0])).normalized();
  }
  const std::vector<Face>& faces() const { return faces_; }
  int face_of(int triangle) const { return face_of_[at(triangle)]; }
  /// Returns the edges that end in a vertex; empty if none of them is sharp.
  const std::vector<int>& corner(int vertex) const { return corners_[at(vertex)]; }
  /// Whether a unit vector at an edge or a vertex is in the normal cone there: its angle with every direction
  /// along a face at this edge or vertex is at least 90 degrees. At a border the vector must also not point
  /// behind the face. `sine` is the tolerance, as the sine of an angle.
  bool points_outward(const Edge& edge, const Vec3<double>& direction, double sine) const;
  bool points_outward(int vertex, const Vec3<double>& direction, double sine) const;
  /// Whether the mesh has no border.
  bool closed() const { return closed_; }
  /// Whether the mesh is a flat plate with two sides and without thickness.
  bool is_plate() const { return closed_ && faces_.size() == 2; }
  /// Whether the mesh is one flat face, or a plate.
  bool is_flat() const { return faces_.size() == 1 || is_plate(); }
  const Eigen::AlignedBox3d& box() const { return nodes_.front().box; }

  /// Finds the triangles whose boxes meet a box, in ascending order; `found` is overwritten.
  void query(const Eigen::AlignedBox3d& box, std::vector<int>& found) const;
  /// Returns the point of a triangle that is nearest to x.
  Vec3<double> nearest(int triangle, const Vec3<double>& x) const;
  /// Whether the distance of x from the mesh is at most `distance` (m).
  bool is_within(const Vec3<double>& x, double distance) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first, count;  ///< range of order_ for a leaf; count is 0 for an inner node
    int second;        ///< second child of an inner node; the first child follows its parent
  };
  void weld(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles);
  void build_edges();
  void build_faces();
  void mark_sharp();
  void build_tree(int first, int count);

  Eigen::Matrix3Xd x_, normals_;
  Eigen::Matrix3Xi triangles_;
  std::vector<Edge> edges_;
  std::vector<std::array<int, 3>> edges_of_;
  std::vector<Face> faces_;
  std::vector<int> face_of_;
  std::vector<std::vector<int>> corners_;
  std::vector<int> order_;  // triangles, leaf by leaf
  std::vector<Node> nodes_;
  bool closed_ = true;
};

}  // namespace pliant
