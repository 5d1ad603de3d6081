// Quadrature over the rest shape of a part, direction by direction. A rule consists of slices or of rings.
// Slices are plane sections z = const of a solid; rings consist of material points (u, w) = const. Each slice
// or ring gives mass points. A node is a point of the one-dimensional rule along z, u, v or w. rule_search.h
// chooses the nodes.
#pragma once

#include <array>
#include <vector>

#include <pliant/math/quadrature.h>
#include <pliant/part/mesh/folds.h>
#include <pliant/part/part.h>

#include "angle_nodes.h"

namespace pliant {

struct RestPoint {
  Material<double> at;
  double mass;  ///< for density 1: volume of a solid (m^3) or area of a shell (m^2)
};

/// A part at rest, and how its material points follow the dynamic parameters.
struct RestShape {
  /// distribution: the mass distribution of the points; nullptr if the density is the same everywhere.
  explicit RestShape(const Part& whole, const MassDistribution* distribution = nullptr);

  const Part& part;
  const MassDistribution* distribution;
  ParameterValues<double> rest;
  const double* a;  ///< parameters of the shape
  Follows follows;  ///< how material points follow the dynamic parameters, with the chain included
  bool dynamic_exponents;
  bool by_sections;   ///< whether the rule uses slices; else it uses rings
  bool points_apart;  ///< whether each point of a ring moves independently; else three points represent the
                      ///< ring
  Kinks along_u, along_v;  ///< for dynamic exponents
  bool octant = false;     ///< whether nodes along u and v cover one octant, and each node has four points
  /// Returns the number of points of each node of v, if points_apart.
  std::size_t images() const { return octant ? 4 : 1; }

 private:
  void find_kinks();
};

// Nodes along one direction. n: number of nodes in a panel (angle_nodes.h has exceptions).

/// A plane section at zeta = z / h, and its weight. h: half height of the shape.
struct SliceNode {
  double zeta, gap, weight;  ///< gap: 1 - |zeta|
};
/// Returns nodes along z. A panel with singular ends has 2 n nodes.
std::vector<SliceNode> slice_nodes(const RestShape& shape, int n);
/// Appends three points that represent the section; none if the section has no area, or if the determinant of
/// the chain is 0 there (a tip). Throws std::invalid_argument if the rest shape folds over there.
void add_slice(const RestShape& shape, const SliceNode& node, std::vector<RestPoint>& out);

/// Signs of the coordinates x, y and z of a mirror image.
using MirrorSigns = std::array<double, 3>;
/// Returns the mirror image of a material point of a shape that the coordinate planes mirror.
Material<double> mirrored(const Material<double>& m, const MirrorSigns& signs);
/// Returns whether each panel of the shape is within one octant.
bool octant_panels(const RestShape& shape);

std::vector<AngleNode> profile_nodes(const RestShape& shape, int n);  ///< along u
std::vector<AngleNode> ring_nodes(const RestShape& shape, int n);     ///< along v
/// Returns n nodes along w; for a shell the node w = 1.
std::vector<QuadratureNode> depth_nodes(const RestShape& shape, int n);
/// Returns the moments m, m x, m y, m x^2, m x y, m y^2 (columns) of the nodes (rows) of a ring, for
/// density 1. x and y: coordinates in which the displacements of the ring are affine. Throws
/// std::invalid_argument if the rest shape folds over there.
Eigen::MatrixXd ring_moments(const RestShape& shape, const AngleNode& u, const QuadratureNode& w,
                             const std::vector<AngleNode>& v);
/// Appends the points of a ring. If shape.points_apart, there is one point for each node of v, or four points
/// if shape.octant; else there are three points, or none if the ring has no mass. Throws
/// std::invalid_argument if the rest shape folds over there.
void add_ring(const RestShape& shape, const AngleNode& u, const QuadratureNode& w,
              const std::vector<AngleNode>& v, std::vector<RestPoint>& out);

}  // namespace pliant
