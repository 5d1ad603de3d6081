// Solid meshes of parts: conforming, bounded by the surface mesh, without slivers, with the correct volume.
#include "catch.h"

#include <cmath>
#include <map>
#include <set>

#include <Eigen/LU>

#include <pliant/local/solid/tetrahedron.h>
#include <pliant/part/mesh/folds.h>
#include <pliant/part/mesh/solid.h>
#include <pliant/part/mesh/surface.h>

#include "random_state.h"
#include "worst.h"

namespace solid_test {

using namespace pliant;
using test::Draws;
using Order = Solid::Order;

namespace {

using Triangle = std::array<int, 3>;
/// Returns the triangle with its nodes rotated so that the smallest number is first.
Triangle smallest_first(Triangle t) {
  while (t[0] > t[1] || t[0] > t[2]) t = {t[1], t[2], t[0]};
  return t;
}
std::set<Triangle> triangle_set(const Eigen::MatrixXi& triangles) {
  std::set<Triangle> all;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    all.insert(smallest_first({triangles(0, t), triangles(1, t), triangles(2, t)}));
  return all;
}
/// Returns the faces of the elements, oriented outwards, that are not shared with another element.
/// `conforming` receives whether no oriented face belongs to two elements.
std::set<Triangle> open_faces(const Eigen::MatrixXi& elements, bool& conforming) {
  constexpr std::array<Triangle, 4> faces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  std::set<Triangle> all;
  conforming = true;
  for (Eigen::Index t = 0; t < elements.cols(); ++t)
    for (const Triangle& f : faces)
      conforming =
          all.insert(smallest_first({elements(f[0], t), elements(f[1], t), elements(f[2], t)})).second &&
          conforming;
  std::set<Triangle> open;
  for (const Triangle& f : all)
    if (all.count(smallest_first({f[0], f[2], f[1]})) == 0) open.insert(f);
  return open;
}

struct Geometry {
  double volume = 0, min_quality = kInfinity, min_jacobian = kInfinity;
};
/// Returns the volume of a mesh with nodes at s, and the smallest quality and Jacobian of its elements. The
/// quality of an element with the volume V is 12 (3 V)^(2/3) / (sum of the squared edge lengths), or 0 if V
/// is not positive. A regular tetrahedron has the quality 1. The Jacobian of a quadratic element is its
/// smallest determinant at quadrature points / its mean determinant; for linear elements it is infinite.
Geometry geometry(const Solid& solid, const Eigen::Matrix3Xd& s) {
  Geometry g;
  for (Eigen::Index t = 0; t < solid.elements().cols(); ++t) {
    std::array<Vec3<double>, 10> x;
    for (Eigen::Index k = 0; k < solid.elements().rows(); ++k)
      x[static_cast<std::size_t>(k)] = s.col(solid.elements()(k, t));
    const double V =
        LinearTetrahedron::gradient<double>(LinearTetrahedron::rule[0], x.data()).determinant() / 6;
    double squares = 0, curved = 0, min_J = kInfinity;
    for (const auto& [a, b] : kTetrahedronEdges) squares += (x[a] - x[b]).squaredNorm();
    g.min_quality = std::min(g.min_quality, V > 0 ? 12 * std::cbrt(9 * V * V) / squares : 0.0);
    if (solid.elements().rows() == 10)
      for (const TetrahedronPoint& at : kTetrahedronMassRule) {
        const double J = QuadraticTetrahedron::gradient<double>(at, x.data()).determinant();
        curved += at.weight * J;
        min_J = std::min(min_J, J);
      }
    g.volume += solid.elements().rows() == 10 ? curved : V;
    g.min_jacobian = std::min(g.min_jacobian, min_J / (6 * curved));
  }
  return g;
}

/// Returns a part whose chain has random rest values within 0.3 of the defaults, without folds.
std::unique_ptr<Part> moderate_part(const std::string& shape, const std::vector<std::string>& chain) {
  std::unique_ptr<Part> part = make_part("part", shape, chain, 1);
  Draws draws(11);
  for (int trial = 0; trial < 1000; ++trial) {
    Part::Named values;
    for (int i = part->parameters().n_shape(); i < part->parameters().size(); ++i) {
      const Parameter& p = part->parameters()[i];
      const double value = p.rest_value() + draws.uniform(-0.3, 0.3);
      values.emplace_back(p.name, std::min(std::max(value, p.spec->frozen.min), p.spec->frozen.max));
    }
    part->rest(values);
    if (!folds(*part, part->parameters().rest())) return part;
  }
  throw std::runtime_error("no shape without folds found");
}
Eigen::Matrix3Xd rest_positions(const Part& part, const Solid& solid) {
  return part.s(solid.material(), part.parameters().rest());
}
/// Returns the smallest quality of the elements of a part at rest.
double quality(const Part& part, int resolution) {
  const Solid solid(part, resolution);
  return geometry(solid, rest_positions(part, solid)).min_quality;
}

}  // namespace

TEST_CASE("solid meshes conform, and their boundary is the surface mesh", "[solid]") {
  for (const auto& face : all_shapes())
    for (const std::vector<std::string>& chain : test::test_chains())
      for (int resolution : {1, 2, 3, 6}) {
        const std::unique_ptr<Part> part = moderate_part(face->name(), chain);
        INFO(test::describe(face->name(), chain) << " " << resolution);
        const Solid solid(*part, resolution);
        const Surface surface(*part, resolution);
        const Eigen::Matrix3Xd s = rest_positions(*part, solid);
        bool conforming = false;
        const std::set<Triangle> open = open_faces(solid.elements(), conforming);
        CHECK(conforming);
        CHECK(open == triangle_set(surface.triangles()));
        CHECK(solid.boundary() == surface.triangles());
        const TriangleMesh mesh = surface.body_mesh(*part, part->parameters().rest());
        REQUIRE(solid.n_surface() == mesh.x.cols());
        CHECK(s.leftCols(solid.n_surface()) == mesh.x);
        const Geometry g = geometry(solid, s);
        CHECK(g.volume == Approx(enclosed_volume(mesh)).epsilon(1e-12));
        CHECK(g.min_quality > 0.02);
        CHECK(solid.elements().minCoeff() == 0);
        CHECK(solid.elements().maxCoeff() == solid.n_nodes() - 1);
        if (face->mesh() == MeshPattern::ball) {
          const int side = 2 * resolution + 1;
          CHECK(solid.n_nodes() == side * side * side);
          CHECK(solid.elements().cols() == 48 * resolution * resolution * resolution);
        }
      }
}

TEST_CASE("solid meshes have no slivers, also at the centre and at tips", "[solid][long]") {
  // A tetrahedron of the undeformed cubic lattice has the quality 0.756.
  for (int resolution : {1, 2, 3, 8, 12}) {
    INFO(resolution);
    for (const char* round : {"sphere", "cylinder", "box"})
      CHECK(quality(*make_part("part", round, {}, 1), resolution) > 0.6);
    CHECK(quality(*make_part("part", "capsule", {}, 1), resolution) > 0.35);
    CHECK(quality(*make_part("part", "cone", {}, 1), resolution) > 0.32);
    CHECK(quality(*make_part("part", "supertoroid", {}, 1), resolution) > 0.35);
    for (const char* shape : {"superellipsoid", "superellipsoid_radial"})
      for (double eps1 : {0.1, 0.3, 1.0, 1.5, 2.0})
        for (double eps2 : {0.1, 0.5, 1.0, 2.0}) {
          INFO(shape << " " << eps1 << " " << eps2);
          std::unique_ptr<Part> part = make_part("part", shape, {}, 1);
          part->rest({{"eps1", eps1}, {"eps2", eps2}});
          CHECK(quality(*part, resolution) > 0.3);
          CHECK_NOTHROW(Solid(*part, resolution > 3 ? 3 : resolution, Order::quadratic));
          CHECK_NOTHROW(Solid(*part, resolution > 3 ? 3 : resolution, Order::enriched));
        }
  }
}

TEST_CASE("the surface of a cone with a tip has no degenerate triangles", "[solid]") {
  for (double t : {-1.0, 1.0}) {
    std::unique_ptr<Part> part = make_part("part", "cone", {}, 1);
    part->rest({{"t", t}});
    const TriangleMesh mesh = Surface(*part, 6).body_mesh(*part, part->parameters().rest());
    double min_J = kInfinity;
    for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
      const Vec3<double> a = mesh.x.col(mesh.triangles(0, i)), b = mesh.x.col(mesh.triangles(1, i)),
                         c = mesh.x.col(mesh.triangles(2, i));
      min_J = std::min(min_J, (b - a).cross(c - a).norm() / 2);
    }
    CHECK(min_J > 1e-3);
    part->prepare();
    CHECK(enclosed_volume(mesh) == Approx(part->total_mass()).epsilon(0.02));
  }
}

TEST_CASE("volumes of solid meshes converge: second order, fourth with quadratic elements", "[solid][long]") {
  for (const auto& face : all_shapes())
    for (const std::vector<std::string>& chain : {std::vector<std::string>{}, {"taper", "bend"}, {"twist"}}) {
      const std::unique_ptr<Part> part = moderate_part(face->name(), chain);
      part->prepare();
      auto error = [&](int resolution, Order order) {
        const Solid solid(*part, resolution, order);
        return geometry(solid, rest_positions(*part, solid)).volume / part->total_mass() - 1;
      };
      INFO(test::describe(face->name(), chain));
      const double linear = error(10, Order::linear), quadratic = error(10, Order::quadratic);
      CHECK(std::abs(linear) < 0.02);
      if (std::abs(linear) > 1e-12)
        CHECK(std::log2(error(5, Order::linear) / linear) == Approx(2).margin(0.15));
      CHECK(std::abs(quadratic) < 2e-4);
      // The surface of a cone is not smooth at its tip, which lowers the order.
      if (std::abs(quadratic) > 1e-12)
        CHECK(std::log2(std::abs(error(5, Order::quadratic) / quadratic)) >
              (part->shape().name() == std::string("cone") ? 2.9 : 3.5));
    }
}

TEST_CASE("nodes of boundary edges are on the surface, nodes of inner edges midway in the undeformed shape",
          "[solid]") {
  for (const auto& face : all_shapes())
    for (const std::vector<std::string>& chain : {std::vector<std::string>{}, {"taper", "bend"}}) {
      const std::unique_ptr<Part> part = moderate_part(face->name(), chain);
      const ParameterValues<double> rest = part->parameters().rest();
      INFO(test::describe(face->name(), chain));
      for (int resolution : {2, 3}) {
        const Solid solid(*part, resolution, Order::quadratic), corners(*part, resolution);
        CHECK(solid.elements().topRows<4>() == corners.elements());
        CHECK(geometry(solid, rest_positions(*part, solid)).min_jacobian > 0.2);
        const int n = solid.n_nodes();
        // The nodes are the corners and one node for each edge. The number of corners - edges + faces -
        // elements is 1 for a ball and 0 for a solid torus (Euler).
        const auto elements = static_cast<int>(solid.elements().cols()),
                   triangles = static_cast<int>(solid.boundary().cols());
        const int faces = (4 * elements + triangles) / 2, edges = n - corners.n_nodes();
        CHECK(corners.n_nodes() - edges + faces - elements == (face->mesh() == MeshPattern::ball ? 1 : 0));
        std::set<int> on_surface;
        for (int i = 0; i < solid.n_surface(); ++i) on_surface.insert(i);
        for (Eigen::Index t = 0; t < solid.boundary().cols(); ++t)
          for (int k = 3; k < 6; ++k) on_surface.insert(solid.boundary()(k, t));
        const Eigen::Matrix3Xd s = rest_positions(*part, solid);
        test::Worst surface_error, middle_error;
        for (int i : on_surface) surface_error.note(std::abs(part->inside_outside(s.col(i), rest)));
        auto e = [&](int i) {
          return part->shape().e(solid.material()[static_cast<std::size_t>(i)], rest.b.data());
        };
        for (Eigen::Index t = 0; t < solid.elements().cols(); ++t)
          for (int k = 0; k < 6; ++k) {
            const auto& [a, b] = kTetrahedronEdges[static_cast<std::size_t>(k)];
            const int node = solid.elements()(4 + k, t);
            if (on_surface.count(node) > 0) continue;
            const Vec3<double> middle = (e(solid.elements()(static_cast<Eigen::Index>(a), t)) +
                                         e(solid.elements()(static_cast<Eigen::Index>(b), t))) /
                                        2;
            middle_error.note((e(node) - middle).norm());
          }
        CHECK(surface_error < 1e-11);
        CHECK(middle_error < 1e-12);
      }
    }
}

TEST_CASE(
    "enriched elements are those of the quadratic mesh with additional nodes on faces and in the middle",
    "[solid]") {
  for (const auto& face : all_shapes()) {
    INFO(face->name());
    const std::unique_ptr<Part> part = moderate_part(face->name(), {"taper", "bend"});
    const Solid solid(*part, 2, Order::enriched), quadratic(*part, 2, Order::quadratic);
    const auto elements = static_cast<int>(solid.elements().cols()),
               triangles = static_cast<int>(solid.boundary().cols());
    CHECK(solid.n_nodes() == quadratic.n_nodes() + (4 * elements + triangles) / 2 + elements);
    CHECK(solid.boundary().topRows<3>() == quadratic.boundary().topRows<3>());
    const Eigen::Matrix3Xd s = rest_positions(*part, solid), quadratic_s = rest_positions(*part, quadratic);
    test::Worst corner_error, surface_error, middle_error;
    double longest = 0;
    for (Eigen::Index t = 0; t < elements; ++t) {
      std::array<Vec3<double>, 15> x;
      for (Eigen::Index k = 0; k < 15; ++k) x[static_cast<std::size_t>(k)] = s.col(solid.elements()(k, t));
      for (Eigen::Index k = 0; k < 10; ++k)
        corner_error.note(
            (s.col(solid.elements()(k, t)) - quadratic_s.col(quadratic.elements()(k, t))).norm());
      for (const auto& [a, b] : kTetrahedronEdges) longest = std::max(longest, (x[a] - x[b]).norm());
      // The nodes are at the positions of the quadratic map, up to the curvature of the surface and the
      // chain.
      for (int r = 0; r < 3; ++r) {
        double bubble[4], middle = 0;
        EnrichedTetrahedron::bubbles(x.data(), r, bubble, middle);
        for (double size : bubble) middle_error.note(std::abs(size));
        middle_error.note(std::abs(middle));
      }
    }
    for (Eigen::Index t = 0; t < triangles; ++t)
      surface_error.note(
          std::abs(part->inside_outside(s.col(solid.boundary()(6, t)), part->parameters().rest())));
    CHECK(corner_error <= 1e-14);
    CHECK(surface_error <= 1e-11);
    CHECK(middle_error <= 0.03 * longest);
  }
}

TEST_CASE("invalid solid meshes are refused", "[solid]") {
  const std::unique_ptr<Part> box = make_part("brick", "box", {"taper", "bend"}, 1);
  CHECK_THROWS_WITH(Solid(*box, 0), test::has_text("from 1 to 64"));
  CHECK_THROWS_WITH(Solid(*box, 65), test::has_text("'brick'"));
  CHECK_THROWS_WITH(Solid(*box, 64), test::has_text("elements of this order; expected at most 2e+06"));
  CHECK_THROWS_WITH(Solid(*box, 24, Order::enriched), test::has_text("expected at most 500000"));
  box->rest({{"taper.tx", -1}, {"taper.ty", -1}});
  CHECK_THROWS_WITH(Solid(*box, 4), test::has_text("flat"));
  const std::unique_ptr<Part> spikes = make_part("spikes", "superellipsoid", {}, 1);
  spikes->rest({{"eps1", 5}, {"eps2", 5}});
  CHECK_THROWS_WITH(Solid(*spikes, 4, Order::quadratic), test::has_text("turned inside out"));
  const std::unique_ptr<Part> ring = make_part("ring", "supertoroid", {}, 1);
  CHECK_THROWS_WITH(Solid(*ring, 1, Order::quadratic), test::has_text("finer"));
  CHECK_NOTHROW(Solid(*ring, 2, Order::quadratic));
}

}  // namespace solid_test
