// The body of a part as a mesh of tetrahedra, made once at the rest shape. Its boundary is the Surface of the
// same resolution: nodes 0 .. n_surface - 1 are the vertices of the surface, in their order.
//
// Balls use the lattice of a cube. Each cell is cut into six tetrahedra around the diagonal that points away
// from the centre (Freudenthal 1942, Kuhn 1960), mirrored in every octant. Shell r of the lattice
// (ball_pattern.h) is the surface of resolution r at w = r / resolution. The section of a torus has rings of
// 4n points at w = n / resolution, with n = resolution, resolution - 2, ..., and a point in the middle. The
// section is swept around the axis; its middle then makes the core ring, a line of nodes.
//
// A quadratic element also has a node on each edge; the order is 0 1 2 3, then 01 12 20 03 13 23. Nodes on
// edges and faces of the boundary are material points of the surface. Nodes on inner edges are in the middle
// of the edge in the undeformed shape. An enriched element also has a node on each face and one in the
// middle.
#pragma once

#include <vector>

#include <pliant/part/part.h>

namespace pliant {

class Solid {
 public:
  enum class Order { linear, quadratic, enriched };

  /// resolution: edges along an eighth of a great circle, from 1 to 64. A ball has (2 resolution + 1)^3
  /// corner nodes and 48 resolution^3 elements. Throws std::invalid_argument for another resolution, for more
  /// than about 2 million linear or half a million other elements, and if an element is turned inside out or
  /// flat at the rest shape.
  Solid(const Part& part, int resolution, Order order = Order::linear);

  const std::vector<Material<double>>& material() const { return material_; }
  /// Nodes of each element: 4, 10 or 15 rows. Elements are positively oriented at the rest shape.
  const Eigen::MatrixXi& elements() const { return elements_; }
  /// Nodes of each triangle of the boundary: 3 rows; 6 rows with nodes on edges 01 12 20; 7 rows with the
  /// node on the face. The triangles are those of the Surface.
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
