// Meshes of solid parts, in the form that the energies of tetrahedra use.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/local/solid/tetrahedron.h>
#include <pliant/part/mesh/solid.h>
#include <pliant/part/registry.h>

#include "worst.h"

namespace pliant::test {

/// Returns the order of elements with this number of nodes.
inline Solid::Order order_of(int n_nodes) {
  return n_nodes == 4    ? Solid::Order::linear
         : n_nodes == 10 ? Solid::Order::quadratic
                         : Solid::Order::enriched;
}

/// A mesh of tetrahedra: rest positions of the nodes (m), node numbers of the elements and of the boundary
/// triangles (columns).
struct SolidMesh {
  Nodes rest;
  Eigen::MatrixXi elements, boundary;
  int n() const { return static_cast<int>(rest.rows()); }
};

/// Returns the mesh of a part at rest. values: rest values; chain: names of the deformations.
inline SolidMesh solid_mesh(const std::string& shape, const Part::Named& values, int resolution,
                            Solid::Order order, const std::vector<std::string>& chain = {}) {
  const std::unique_ptr<Part> part = make_part("part", shape, chain, 1);
  part->rest(values);
  const Solid solid(*part, resolution, order);
  return {part->s(solid.material(), part->parameters().rest()).transpose(), solid.elements(),
          solid.boundary()};
}

/// Returns a bent and tapered box of 48 elements of all orientations, or of 8 x 48 elements if they have 4
/// nodes.
inline SolidMesh crooked_box(int n_nodes) {
  return solid_mesh("box", {{"a1", 0.7}, {"a3", 1.4}, {"taper.tx", 0.2}, {"bend.angle", 0.4}},
                    n_nodes == 4 ? 2 : 1, order_of(n_nodes), {"taper", "bend"});
}

/// Returns the mesh with the face and middle nodes at the quadratic interpolation of the other nodes. Its
/// elements of 15 nodes have the geometry of elements of 10 nodes.
inline SolidMesh without_bubbles(SolidMesh mesh) {
  std::array<Vec3<double>, EnrichedTetrahedron::n_nodes> X;
  std::array<Vec3<double>, 5> size;  // coefficients of the bubbles of the faces and the middle
  auto measure = [&] {
    for (int r = 0; r < 3; ++r) {
      double face[4], middle;
      EnrichedTetrahedron::bubbles(X.data(), r, face, middle);
      for (std::size_t f = 0; f < 4; ++f) size[f][r] = face[f];
      size[4][r] = middle;
    }
  };
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e) {
    for (std::size_t a = 0; a < X.size(); ++a)
      X[a] = mesh.rest.row(mesh.elements(static_cast<Eigen::Index>(a), e));
    measure();
    for (std::size_t f = 0; f < 4; ++f) X[10 + f] -= size[f];
    measure();
    X[14] -= size[4];
    for (std::size_t a = 10; a < X.size(); ++a)
      mesh.rest.row(mesh.elements(static_cast<Eigen::Index>(a), e)) = X[a].transpose();
  }
  return mesh;
}

/// Returns the largest norm of the forces f on inner nodes.
inline double largest_inside(const VecX<double>& f, const SolidMesh& mesh) {
  std::vector<bool> is(static_cast<std::size_t>(mesh.n()), true);
  for (Eigen::Index i = 0; i < mesh.boundary.size(); ++i)
    is[static_cast<std::size_t>(mesh.boundary(i))] = false;
  Worst largest;
  for (int i = 0; i < mesh.n(); ++i)
    if (is[static_cast<std::size_t>(i)]) largest.note(nodes(f, mesh.n()).row(i).norm());
  return largest;
}

/// Returns local coordinates whose vector at each node is A X + b, with the rest position X of the node.
inline VecX<double> affine(const Nodes& X, const Mat3<double>& A, const Vec3<double>& b) {
  VecX<double> x(3 * X.rows());
  nodes(x, X.rows()) = (X * A.transpose()).rowwise() + b.transpose();
  return x;
}

}  // namespace pliant::test
