// Meshes of solid parts as the energies of tetrahedra take them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/part/registry.h>
#include <pliant/part/solid.h>

namespace pliant::test {

/// The order of elements of so many nodes.
inline Solid::Order order_of(int n_nodes) {
  return n_nodes == 4    ? Solid::Order::linear
         : n_nodes == 10 ? Solid::Order::quadratic
                         : Solid::Order::enriched;
}

struct SolidMesh {
  Nodes rest;
  Eigen::MatrixXi elements, boundary;
  int n() const { return static_cast<int>(rest.rows()); }
};

inline SolidMesh solid_mesh(const std::string& shape, const Part::Named& values, int resolution,
                            Solid::Order order, const std::vector<std::string>& chain = {}) {
  const std::unique_ptr<Part> part = make_part("part", shape, chain, 1);
  part->rest(values);
  const Solid solid(*part, resolution, order);
  return {part->s(solid.material(), part->parameters().rest()).transpose(), solid.elements(),
          solid.boundary()};
}

/// Positions or displacements A X + b of all nodes.
inline VecX<double> affine(const Nodes& X, const Mat3<double>& A, const Vec3<double>& b) {
  VecX<double> x(3 * X.rows());
  nodes(x, X.rows()) = (X * A.transpose()).rowwise() + b.transpose();
  return x;
}

}  // namespace pliant::test
