// Meshes of parts: nodal masses, and weights of material points.
#include <pliant/part/local/local_mesh.h>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <pliant/local/solid/solid_mass.h>
#include <pliant/local/solid/tetrahedron.h>
#include <pliant/part/mesh/solid.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/part/part.h>

#include "part/quadrature/match_moments.h"

namespace pliant {

VecX<double> LocalMesh::areas() const {
  VecX<double> area = VecX<double>::Zero(X.rows());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Vec3<double> { return X.row(triangles(k, t)).transpose(); };
    const double third = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 6;
    for (int k = 0; k < 3; ++k) area[triangles(k, t)] += third;
  }
  return area;
}

namespace {

/// Returns the barycentric weights of the point of a triangle that is nearest to x.
Vec3<double> nearest_on_triangle(const Vec3<double>& x, const std::array<Vec3<double>, 3>& corner) {
  const Vec3<double> e1 = corner[1] - corner[0], e2 = corner[2] - corner[0], r = x - corner[0];
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2), d = e1.dot(r), e = e2.dot(r);
  const double det = a * c - b * b;
  const double s = (c * d - b * e) / det, t = (a * e - b * d) / det;
  if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  Vec3<double> best = Vec3<double>::Zero();
  double least_distance = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>((k + 1) % 3);
    const Vec3<double> edge = corner[j] - corner[i];
    const double along = std::clamp((x - corner[i]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    const double distance = (x - corner[i] - along * edge).squaredNorm();
    if (distance >= least_distance) continue;
    least_distance = distance;
    best.setZero();
    best[k] = 1 - along;
    best[(k + 1) % 3] = along;
  }
  return best;
}

/// Returns the weights of a position x of a shell: the weights of the point nearest to x on any triangle.
NodeWeights weights_on_triangles(const LocalMesh& mesh, const Vec3<double>& x) {
  NodeWeights best;
  double least_distance = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    std::array<Vec3<double>, 3> corner;
    for (int k = 0; k < 3; ++k)
      corner[static_cast<std::size_t>(k)] = mesh.X.row(mesh.triangles(k, t)).transpose();
    const Vec3<double> weight = nearest_on_triangle(x, corner);
    const double distance =
        (x - weight[0] * corner[0] - weight[1] * corner[1] - weight[2] * corner[2]).squaredNorm();
    if (distance >= least_distance) continue;
    least_distance = distance;
    best = {};
    for (int k = 0; k < 3; ++k) {
      if (weight[k] == 0) continue;
      best.node.push_back(mesh.triangles(k, t));
      best.weight.push_back(weight[k]);
    }
  }
  return best;
}

/// Returns the weights of a position x in an element. L: the barycentric coordinates of x in the straight
/// element with the same corners, at which the search starts.
template <class Element>
NodeWeights weights_in(const LocalMesh& mesh, Eigen::Index element, const Vec3<double>& x,
                       std::array<double, 4> L) {
  std::array<Vec3<double>, Element::n_nodes> X;
  for (int k = 0; k < Element::n_nodes; ++k)
    X[static_cast<std::size_t>(k)] = mesh.X.row(mesh.tetrahedra(k, element)).transpose();
  // Newton's method with a fixed number of iterations. One iteration suffices if the element is straight.
  constexpr int kIterations = 10;
  for (int i = 0; i < kIterations; ++i) {
    const TetrahedronPoint at{L, 0};
    const auto N = Element::N(at);
    Vec3<double> miss = x;
    for (int k = 0; k < Element::n_nodes; ++k) miss -= N[k] * X[static_cast<std::size_t>(k)];
    const Vec3<double> step = Element::gradient(at, X.data()).inverse() * miss;
    L[0] -= step.sum();
    for (std::size_t k = 0; k < 3; ++k) L[k + 1] += step[static_cast<Eigen::Index>(k)];
  }
  NodeWeights at;
  const auto N = Element::N({L, 0});
  for (int k = 0; k < Element::n_nodes; ++k) {
    at.node.push_back(mesh.tetrahedra(k, element));
    at.weight.push_back(N[k]);
  }
  return at;
}

/// Returns the weights of a position x of a solid over the nodes of one element: the element in which the
/// smallest barycentric coordinate of x is largest. If elements are straight and x is inside the mesh, this
/// element contains x.
NodeWeights weights_in_elements(const LocalMesh& mesh, const Vec3<double>& x) {
  Eigen::Index in = 0;
  std::array<double, 4> L{};
  double inside = -std::numeric_limits<double>::infinity();
  Eigen::Matrix4d corners;
  corners.row(3).setOnes();
  for (Eigen::Index t = 0; t < mesh.tetrahedra.cols(); ++t) {
    for (int k = 0; k < 4; ++k) corners.col(k).head<3>() = mesh.X.row(mesh.tetrahedra(k, t)).transpose();
    const Vec<double, 4> at = corners.inverse() * x.homogeneous();
    if (!(at.minCoeff() > inside)) continue;
    inside = at.minCoeff();
    in = t;
    Eigen::Map<Vec<double, 4>>(L.data()) = at;
  }
  if (mesh.tetrahedra.rows() == 4) return weights_in<LinearTetrahedron>(mesh, in, x, L);
  if (mesh.tetrahedra.rows() == 10) return weights_in<QuadraticTetrahedron>(mesh, in, x, L);
  return weights_in<EnrichedTetrahedron>(mesh, in, x, L);
}

/// Splits faces into flat triangles. faces: one face in each column, with 3, 6 or 7 nodes (see Solid), which
/// gives 1, 4 or 6 triangles.
Eigen::Matrix3Xi flat_triangles(const Eigen::MatrixXi& faces) {
  if (faces.rows() == 3) return faces;
  if (faces.rows() == 6) {
    constexpr int four[4][3] = {{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}};
    Eigen::Matrix3Xi triangles(3, 4 * faces.cols());
    for (Eigen::Index f = 0; f < faces.cols(); ++f)
      for (int i = 0; i < 4; ++i)
        triangles.col(4 * f + i) << faces(four[i][0], f), faces(four[i][1], f), faces(four[i][2], f);
    return triangles;
  }
  constexpr int round[7] = {0, 3, 1, 4, 2, 5, 0}, middle = 6;
  Eigen::Matrix3Xi triangles(3, 6 * faces.cols());
  for (Eigen::Index f = 0; f < faces.cols(); ++f)
    for (int i = 0; i < 6; ++i)
      triangles.col(6 * f + i) << faces(round[i], f), faces(round[i + 1], f), faces(middle, f);
  return triangles;
}

}  // namespace

LocalMesh make_local_mesh(const Part& part, const LocalSettings& settings) {
  LocalMesh mesh;
  if (part.shell()) {
    const Surface surface(part, settings.resolution);
    mesh.nodes = surface.material();
    mesh.triangles = surface.triangles();
  } else {
    // Modes use the consistent mass matrix, which is positive definite for elements with 10 nodes.
    const bool modes = settings.basis == LocalSettings::Basis::modes;
    const Solid solid(part, settings.resolution,
                      settings.order == 1 ? Solid::Order::linear
                                          : (modes ? Solid::Order::quadratic : Solid::Order::enriched));
    mesh.nodes = solid.material();
    mesh.triangles = flat_triangles(solid.boundary());
    mesh.tetrahedra = solid.elements();
  }
  mesh.X = part.s(mesh.nodes, part.parameters().rest()).transpose();
  mesh.mass = part.shell() ? mesh.areas() : lumped_mass(mesh.X, mesh.tetrahedra, 1);
  if (part.mass_distribution() != nullptr)
    mesh.mass.array() *= mass_multiples(part, *part.mass_distribution(), mesh.nodes).array();
  mesh.density = part.total_mass() / mesh.mass.sum();
  mesh.mass *= mesh.density;
  const double missing = match_moments(part.rest_inertia(), mesh.X, mesh.mass);
  const std::string of_mesh =
      "part '" + part.name() + "': a mesh of resolution " + std::to_string(settings.resolution);
  if (!(missing <= kMatched)) {
    std::ostringstream message;
    message << of_mesh
            << " cannot have the mass, the centre and the inertia of the part: a relative share of "
            << missing << " of a moment is missing; expected another resolution, or a part that is less thin";
    throw LocalFault(message.str());
  }
  if (Eigen::Index k = 0; part.mass_distribution() != nullptr && !(mesh.mass.minCoeff(&k) > 0)) {
    const Vec3<double> X = mesh.X.row(k);
    std::ostringstream message;
    message << of_mesh << " has a node without mass at X = " << X[0] << ", Y = " << X[1] << ", Z = " << X[2]
            << "; expected a mass distribution that is above 0 at each node";
    throw LocalFault(message.str());
  }
  if (!(mesh.mass.minCoeff() > 0)) throw LocalFault(of_mesh + " is too coarse for its masses to be positive");
  return mesh;
}

NodeWeights mesh_weights(const Part& part, const LocalMesh& mesh, const Material<double>& m) {
  if (mesh.shell() && m.w < 1) return {};
  const Vec3<double> x = part.s({m}, part.parameters().rest()).col(0);
  return mesh.shell() ? weights_on_triangles(mesh, x) : weights_in_elements(mesh, x);
}

}  // namespace pliant
