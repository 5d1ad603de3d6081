// find_touches() and a comparison with every triangle find the same vertices inside another mesh.
#include "catch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/collision/mesh/mesh_touches.h>
#include <pliant/part/registry.h>

#include "draws.h"

namespace mesh_touches_test {

using namespace pliant;
using test::Draws;
using test::random_rotation;

namespace {

/// Returns the squared distance of x to a triangle, by projection to its plane and to its three edges.
double square_to(const Vec3<double>& x, const std::array<Vec3<double>, 3>& p) {
  const Vec3<double> normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  const double height = normal.dot(x - p[0]);
  const Vec3<double> foot = x - height * normal;
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3<double> along = p[(k + 1) % 3] - p[k];
    inside = inside && normal.cross(along).dot(foot - p[k]) >= 0;
    const double s = std::clamp(along.dot(x - p[k]) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p[k] + s * along - x).squaredNorm());
  }
  return inside ? height * height : nearest;
}

/// Returns whether x is behind the nearest triangle of a mesh, and whether the nearest point of this triangle
/// is the projection of x onto its plane. Among equally near triangles, the triangle with the largest
/// distance of x from its plane decides.
bool is_inside(const Vec3<double>& x, const PlacedMesh& m) {
  std::vector<std::pair<double, double>> triangles;  // squared distance, height
  double nearest = std::numeric_limits<double>::infinity(), gap = 0;
  for (Eigen::Index t = 0; t < m.mesh->triangles().cols(); ++t) {
    std::array<Vec3<double>, 3> p;
    for (int k = 0; k < 3; ++k) p[static_cast<std::size_t>(k)] = m.x.col(m.mesh->triangles()(k, t));
    triangles.emplace_back(square_to(x, p), (p[1] - p[0]).cross(p[2] - p[0]).normalized().dot(x - p[0]));
    nearest = std::min(nearest, triangles.back().first);
  }
  for (const auto& [square, height] : triangles)
    if (square <= nearest * (1 + 1e-9) && std::abs(height) > std::abs(gap)) gap = height;
  return gap < 0 && nearest <= gap * gap * (1 + 1e-6);
}

}  // namespace

TEST_CASE("vertices inside another mesh", "[collision]") {
  MultiBody body;
  for (const char* shape : {"ellipsoid", "box"})
    body.add(make_part(shape, shape, {}, 1000)).rest({{"a1", 0.4}, {"a2", 0.9}, {"a3", 1.1}});
  const Model model(body);
  const State state = model.initial_state();
  Draws draws(5);
  int inside = 0;
  for (int trial = 0; trial < 14; ++trial) {
    const int number = trial % 2;
    const ContactMesh mesh(model.parts()[0], 0), other(model.parts()[static_cast<std::size_t>(number)], 0);
    auto placed = [&](const ContactMesh& m, int part, const Vec3<double>& at) {
      Eigen::Matrix3Xd x = random_rotation(draws).toRotationMatrix() * m.positions(model, state, part);
      for (Eigen::Index k = 0; k < x.cols(); ++k) x.col(k) += at + draws.vector(0.004);
      return PlacedMesh(m, x);
    };
    PlacedMesh a = placed(mesh, 0, Vec3<double>::Zero());
    const Vec3<double> towards = draws.vector(1).normalized();
    PlacedMesh b = placed(other, number, Vec3<double>::Zero());
    const double apart = (towards.transpose() * a.x).maxCoeff() - (towards.transpose() * b.x).minCoeff();
    b = PlacedMesh(other, b.x.colwise() + (apart - draws.uniform(0.01, 0.15)) * towards);
    std::vector<MeshTouch> touches;
    find_touches(a, b, touches);
    std::set<std::pair<int, int>> found, expected;  // side and vertex
    for (const MeshTouch& touch : touches) {
      if (touch.a.vertex[1] < 0) found.insert({0, touch.a.vertex[0]});
      if (touch.b.vertex[1] < 0) found.insert({1, touch.b.vertex[0]});
    }
    for (int k = 0; k < a.x.cols(); ++k)
      if (is_inside(a.x.col(k), b)) expected.insert({0, k});
    for (int k = 0; k < b.x.cols(); ++k)
      if (is_inside(b.x.col(k), a)) expected.insert({1, k});
    INFO("trial " << trial);
    CHECK(found == expected);
    inside += static_cast<int>(expected.size());
  }
  CHECK(inside > 14);
}

TEST_CASE("vertices in a shallow dent are inside", "[collision]") {
  MultiBody body;
  body.add(make_part("box", "box", {}, 1000)).rest({{"a1", 1.0}, {"a2", 1.0}, {"a3", 1.0}});
  body.add(make_part("ball", "ellipsoid", {}, 1000)).rest({{"a1", 0.04}, {"a2", 0.04}, {"a3", 0.04}});
  const Model model(body);
  const State state = model.initial_state();
  const ContactMesh box(model.parts()[0], 0), ball(model.parts()[1], 0);
  const Eigen::Matrix3Xd flat = box.positions(model, state, 0), small = ball.positions(model, state, 1);
  Eigen::Index middle = 0, lowest = 0;
  (flat.colwise() - Vec3<double>(0, 0, 1)).colwise().norm().minCoeff(&middle);
  small.row(2).minCoeff(&lowest);
  const double edge = 1.0 / 6;
  Draws draws(3);
  int inside = 0;
  for (int trial = 0; trial < 400; ++trial) {
    // A point close below the vertex of the dent is projected onto the plane of an adjacent triangle. The
    // projection is outside this triangle, by slope * depth.
    const double slope = std::pow(10, draws.uniform(-5, -3)), depth = draws.uniform(0.01, 0.1) * edge;
    Eigen::Matrix3Xd dented = flat;
    dented(2, middle) -= slope * edge;
    const Vec3<double> offset(draws.uniform(-2, 2) * slope * depth, draws.uniform(-2, 2) * slope * depth, 0);
    const Vec3<double> target = dented.col(middle) + offset - depth * Vec3<double>::UnitZ();
    const PlacedMesh a(ball, small.colwise() + (target - small.col(lowest))), b(box, dented);
    std::vector<MeshTouch> touches;
    find_touches(a, b, touches);
    const bool found = std::any_of(touches.begin(), touches.end(), [&](const MeshTouch& touch) {
      return touch.a.vertex[1] < 0 && touch.a.vertex[0] == lowest;
    });
    INFO("trial " << trial << ", slope " << slope);
    CHECK(found == is_inside(target, b));
    inside += found ? 1 : 0;
  }
  CHECK(inside > 100);
}

}  // namespace mesh_touches_test
