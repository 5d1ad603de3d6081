// The body of a part as a mesh of tetrahedra, made once at the rest shape. Its boundary is the Surface of the
// same resolution: nodes 0 .. n_surface - 1 are the vertices of the surface, in their order.
//
// Balls use the lattice of a cube. Each cell is cut into six tetrahedra around the diagonal that points away
// from the centre of the cube (Freudenthal 1942, Kuhn 1960). Shell r of the lattice (ball_pattern.h) is the
// surface of resolution r at w = r / resolution. The section of a torus has rings of 4n points at
// w = n / resolution, with n = resolution, resolution - 2, ... > 0, and a point in the middle. The mesh of a
// torus repeats this section around the axis; the middle points then make a line of nodes, the core ring.
//
// A linear element has the corners 0 1 2 3. A quadratic element has six more nodes, on the edges 01 12 20 03
// 13 23. An enriched element has five more nodes: one on each face, in the order of the opposite corners, and
// one in the middle. Nodes on edges and faces of the boundary are material points of the surface. Nodes on
// inner edges are in the middle of the edge in the undeformed shape.
#pragma once

#include <vector>

#include <pliant/part/part.h>

namespace pliant {

class Solid {
 public:
  enum class Order { linear, quadratic, enriched };

  /// resolution: for a ball the number of edges along an eighth of a great circle, from 1 to 64. A ball has
  /// (2 resolution + 1)^3 corner nodes and 48 resolution^3 elements. Throws std::invalid_argument for a
  /// resolution outside 1 to 64, if 48 resolution^3 exceeds 2 million for linear or half a million for other
  /// elements, and if an element is turned inside out or flat at the rest shape.
  Solid(const Part& part, int resolution, Order order = Order::linear);

  const std::vector<Material<double>>& material() const { return material_; }
  /// Nodes of each element (column): 4, 10 or 15 rows. Elements are positively oriented at the rest shape.
  const Eigen::MatrixXi& elements() const { return elements_; }
  /// Nodes of each triangle (column) of the boundary: 3 rows for linear elements; 6 rows, with the nodes on
  /// the edges 01 12 20, for quadratic elements; 7 rows, with the node on the face too, for enriched
  /// elements. The triangles are those of the Surface of this resolution.
  const Eigen::MatrixXi& boundary() const { return boundary_; }
  /// Number of corner nodes on the surface.
  int n_surface() const { return n_surface_; }
  int n_nodes() const { return static_cast<int>(material_.size()); }

 private:
  std::vector<Material<double>> material_;
  Eigen::MatrixXi elements_, boundary_;
  int n_surface_ = 0;
};

}  // namespace pliant
