// An immobile triangle mesh as contact sees it: checked, its equal vertices one, with its edges, its flat
// faces and a tree of boxes.
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
  /// vertices: m, world. triangles: columns of these, counter-clockwise seen from the side that is free; what
  /// comes from the other side passes. Throws std::invalid_argument with the element and its place: a vertex
  /// that is not finite or in no triangle, a triangle of no vertex or without area, an edge with more than
  /// two triangles or with two that are turned against each other.
  ObstacleMesh(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles);

  struct Edge {
    std::array<int, 2> vertex;    ///< triangle[0] is on its left, seen from the free side
    std::array<int, 2> triangle;  ///< the second is -1 at the border of an open mesh
    bool sharp;                   ///< what is outside of both faces may touch it: a ridge, or the border
  };
  /// Triangles that are connected and in one plane.
  struct Face {
    Vec3<double> point, normal;
  };

  const Eigen::Matrix3Xd& vertices() const { return x_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  const std::vector<Edge>& edges() const { return edges_; }
  /// Of the corners 0 to 1, 1 to 2 and 2 to 0 of a triangle.
  const std::array<int, 3>& edges_of(int triangle) const { return edges_of_[at(triangle)]; }
  Vec3<double> normal(int triangle) const { return normals_.col(triangle); }
  /// Along an edge, of length 1.
  Vec3<double> along(const Edge& edge) const {
    return (x_.col(edge.vertex[1]) - x_.col(edge.vertex[0])).normalized();
  }
  const std::vector<Face>& faces() const { return faces_; }
  int face_of(int triangle) const { return face_of_[at(triangle)]; }
  /// Numbers of the edges that end in a vertex; empty where none of them is sharp.
  const std::vector<int>& corner(int vertex) const { return corners_[at(vertex)]; }
  /// Whether a direction, of length 1, at an edge or a corner points away from the faces that meet there, but
  /// for this sine.
  bool leads_out(const Edge& edge, const Vec3<double>& direction, double sine) const;
  bool leads_out(int vertex, const Vec3<double>& direction, double sine) const;
  /// Whether it has no border.
  bool closed() const { return closed_; }
  /// Whether it is flat and has two sides.
  bool is_plate() const { return closed_ && faces_.size() == 2; }
  const Eigen::AlignedBox3d& box() const { return nodes_.front().box; }

  /// Triangles whose boxes meet a box, in order; `found` is overwritten.
  void query(const Eigen::AlignedBox3d& box, std::vector<int>& found) const;
  /// The point of a triangle that is nearest to x.
  Vec3<double> nearest(int triangle, const Vec3<double>& x) const;
  /// Whether any triangle is nearer to x than this, m.
  bool comes_near(const Vec3<double>& x, double distance) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first, count;  ///< in order_; its children follow it at once and at `second` when it has no triangles
    int second;
  };
  void weld(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles);
  void lay_edges();
  void lay_faces();
  void mark_sharp();
  void lay_tree(int first, int count);

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
