// Rules over the rest shape of a part, direction by direction: slices of a solid by its plane sections, or
// rings of material points (u, w) = const. Each node of a rule gives the mass points it stands for;
// mass_points.cpp chooses the nodes.
#pragma once

#include <vector>

#include <pliant/math/quadrature.h>
#include <pliant/part/mesh/folds.h>
#include <pliant/part/part.h>

namespace pliant {

struct RestPoint {
  Material<double> at;
  double mass;  ///< of unit density
};

/// What the rules are made for: a part at rest and what its dynamic parameters can do.
struct RestShape {
  explicit RestShape(const Part& of);

  const Part& part;
  ParameterValues<double> rest;
  const double* a;  ///< parameters of the shape
  Follows follows;  ///< how material points follow the dynamic parameters, the chain considered
  bool dynamic_exponents;
  bool by_sections;   ///< slices serve; else rings
  bool points_apart;  ///< every point of a ring moves by itself, else three points stand for it
};

// Nodes along one direction: n in each panel.

/// A section at zeta = z / h, and its weight.
struct SliceNode {
  double zeta, gap, weight;  ///< gap: 1 - |zeta|
};
std::vector<SliceNode> slice_nodes(const RestShape& shape, int n);
/// Three points of the section; none where it has no area.
void add_slice(const RestShape& shape, const SliceNode& node, std::vector<RestPoint>& out);

/// A node along a material angle: its cosine and sine with their derivatives by the variable of the rule.
struct AngleNode {
  Trig<Dual<1>> c, s;
  double weight;
};
std::vector<AngleNode> profile_nodes(const RestShape& shape, int n);  ///< along u
std::vector<AngleNode> ring_nodes(const RestShape& shape, int n);     ///< along v
std::vector<QuadratureNode> depth_nodes(const RestShape& shape,
                                        int n);  ///< along w; of a shell the surface alone
/// The points of a ring: one a node of v when they are apart, else three, or none when it has no mass.
void add_ring(const RestShape& shape, const AngleNode& u, const QuadratureNode& w,
              const std::vector<AngleNode>& v, std::vector<RestPoint>& out);

}  // namespace pliant
