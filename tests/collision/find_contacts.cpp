// Contacts are compared with closed forms. The closed forms of ellipsoids are compared with the search for
// other shapes, and the pairs of the broad phase with all pairs of near boxes.
// N55 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <pliant/collision/box_tree.h>
#include <pliant/collision/ellipsoid_points.h>
#include <pliant/collision/find_contacts.h>
#include <pliant/part/registry.h>

#include "draws.h"
#include "solid_kind.h"

namespace find_contacts_test {

using namespace pliant;
using test::Draws;
using test::random_rotation;

namespace {

Part& ellipsoid(MultiBody& body, const char* name, const Vec3<double>& axes, const Vec3<double>& at,
                const Eigen::Quaterniond& R) {
  Part& part = body.add(make_part(name, "ellipsoid", {}, 1000));
  return part.rest({{"a1", axes[0]}, {"a2", axes[1]}, {"a3", axes[2]}}).place(at, R);
}

std::vector<Contact> contacts_of(MultiBody& body, double most) {
  const Model model(body);
  return ContactFinder(model).find(model.initial_state(), 0, most);
}

}  // namespace

TEST_CASE("the lowest point of an ellipsoid over a plane", "[contact]") {
  Draws draws(11);
  for (int trial = 0; trial < 60; ++trial) {
    const Vec3<double> axes(draws.uniform(0.01, 1), draws.uniform(0.1, 1), draws.uniform(0.1, 1));
    const Eigen::Quaterniond R = random_rotation(draws);
    const Vec3<double> n = draws.vector(1).normalized(), c = draws.vector(2);
    const double depth = axes.cwiseProduct(R.inverse() * n).norm();
    MultiBody body;
    Part& part = ellipsoid(body, "part", axes, c, R);
    if (trial % 2 == 1) part.stiffness({{"a1", 1e3}, {"a2", 1e3}, {"a3", 1e3}});
    body.plane("plane", TimeVector(c - (depth + 1e-3) * n), n);
    CHECK(contacts_of(body, 0.9e-3).empty());
    const std::vector<Contact> found = contacts_of(body, 1.1e-3);
    REQUIRE(found.size() == 1);
    CHECK(found[0].gap == Approx(1e-3).margin(1e-14));
    CHECK(found[0].normal == body.contact.planes[0].normal);
    const Vec3<double> lowest = c - R * (axes.cwiseAbs2().cwiseProduct(R.inverse() * n)) / depth;
    CHECK((found[0].x - lowest).norm() < 1e-14);
    const Model model(body);
    CHECK((model.world_point(model.initial_state(), 0, found[0].a.material) - lowest).norm() < 1e-14);
  }
}

TEST_CASE("the lowest points of tori, capsules, cylinders and cones over a plane", "[contact]") {
  // A contact on a rim is at a vertex of the sample mesh or between two vertices. It may be above the lowest
  // point of the part; `above` is the largest allowed height, m.
  struct Kind {
    const char* shape;
    Part::Named rest;
    // depth of the lowest point below the centre, m; along, across: components of the plane normal along and
    // across the axis of the shape
    std::function<double(double, double)> depth;
    double above;
  };
  const std::vector<Kind> kinds{
      {"supertoroid",
       {{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.05}, {"a4", 3}},
       [](double, double across) { return 0.05 + 0.15 * across; },
       1e-15},
      {"capsule",
       {{"r", 0.05}, {"l", 0.4}},
       [](double along, double) { return 0.05 + 0.2 * std::abs(along); },
       1e-15},
      {"cylinder",
       {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}},
       [](double along, double across) { return 0.15 * std::abs(along) + 0.1 * across; },
       1e-4},
      {"cone",
       {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}, {"t", -0.5}},
       [](double along, double across) {
         return std::max(0.05 * across - 0.15 * along, 0.15 * across + 0.15 * along);
       },
       1e-4}};
  Draws draws(16);
  for (const Kind& kind : kinds)
    for (int trial = 0; trial < 60; ++trial) {
      CAPTURE(kind.shape, trial);
      const Eigen::Quaterniond R = random_rotation(draws);
      const Vec3<double> n = R.conjugate() * Vec3<double>::UnitZ();
      MultiBody body;
      body.add(make_part("part", kind.shape, {}, 1000))
          .rest(kind.rest)
          .place({0, 0, kind.depth(n[2], n.head<2>().norm())}, R);
      body.plane("plane", Vec3<double>(0, 0, 0), {0, 0, 1});
      const std::vector<Contact> found = contacts_of(body, 1e-3);
      REQUIRE_FALSE(found.empty());
      double lowest = 1;
      for (const Contact& contact : found) lowest = std::min(lowest, contact.gap);
      CHECK(lowest > -1e-15);
      CHECK(lowest < kind.above);
    }
}

TEST_CASE("an ellipsoid and a ball: the error of the gap is of second order, for both orders of the parts",
          "[contact]") {
  Draws draws(12);
  for (int trial = 0; trial < 60; ++trial) {
    const Vec3<double> axes(draws.uniform(0.1, 1), draws.uniform(0.1, 1), draws.uniform(0.1, 1));
    const Eigen::Quaterniond R = random_rotation(draws);
    const Vec3<double> c = draws.vector(2), y = draws.vector(1).normalized();
    const Vec3<double> n = (R * y.cwiseQuotient(axes)).normalized(), x = c + R * axes.cwiseProduct(y);
    const double r = draws.uniform(0.05, 1);
    std::vector<double> errors;
    for (const double gap : {1e-3, 1e-4, -1e-3, -1e-4, 0.0}) {
      MultiBody body;
      body.contact.active = true;
      const bool ball_first = trial % 2 == 1;
      if (!ball_first) ellipsoid(body, "part", axes, c, R);
      body.add(make_part("ball", "sphere", {}, 1000)).rest({{"r", r}}).place(x + (r + gap) * n);
      if (ball_first) ellipsoid(body, "part", axes, c, R);
      const std::vector<Contact> found = contacts_of(body, 0.01);
      REQUIRE(found.size() == 1);
      errors.push_back(std::abs(found[0].gap - gap));
      CHECK(errors.back() <= 100 * gap * gap + 1e-14);
      const double sharp =
          axes.maxCoeff() / std::pow(axes.minCoeff(), 2);  // the largest curvature of the ellipsoid
      CHECK((found[0].normal - (ball_first ? n : -n)).norm() < 2 * (sharp + 1 / r) * std::abs(gap) + 1e-13);
      CHECK((found[0].x - x).norm() < 20 * std::abs(gap) + 1e-13);
    }
    // From a gap of 1e-3 to a gap of 1e-4 the error falls by a factor of 100. If the gap is measured from the
    // ball, for which the formula is exact, both errors are rounding.
    CHECK(errors[1] < 0.03 * errors[0] + 1e-13);
    CHECK(errors[3] < 0.03 * errors[2] + 1e-13);
  }
}

TEST_CASE("the nearest point of a stretched ball is the global minimum of the distance", "[contact]") {
  Draws draws(13);
  for (int trial = 0; trial < 300; ++trial) {
    Mat3<double> M;
    for (double& entry : M.reshaped()) entry = draws.uniform(-1, 1);
    if (trial % 3 == 1) M = Vec3<double>(1, draws.uniform(0, 2) < 1 ? 1 : 2, 3).asDiagonal();
    if (trial % 3 == 2) M.setIdentity();
    Vec3<double> r = draws.vector(2);
    if (trial % 4 == 1) r.setZero();                   // concentric
    if (trial % 4 == 2) r = Vec3<double>(0, 0, r[0]);  // on an axis
    const Vec3<double> y = nearest_direction(M, r);
    REQUIRE(y.norm() == Approx(1).epsilon(1e-14));
    const double distance = (M * y + r).norm();
    for (int k = 0; k < 300; ++k) REQUIRE(distance <= (M * draws.vector(1).normalized() + r).norm() + 1e-13);
    // At a stationary point the gradient has no component tangential to the sphere.
    const Vec3<double> gradient = M.transpose() * (M * y + r);
    CHECK((gradient - gradient.dot(y) * y).norm() < 1e-12 * (1 + M.squaredNorm()));
  }
}

TEST_CASE("the closed forms of ellipsoids agree with the support functions of other shapes",
          "[contact][long]") {
  Draws draws(14);
  for (int trial = 0; trial < 12; ++trial) {
    const Vec3<double> axes(draws.uniform(0.2, 1), draws.uniform(0.2, 1), draws.uniform(0.2, 1));
    const Eigen::Quaterniond R = random_rotation(draws), R_b = random_rotation(draws);
    const Vec3<double> n = draws.vector(1).normalized(), away = draws.vector(1).normalized();
    double apart = 2;
    auto contacts = [&](const char* shape, double most) {
      MultiBody body;
      Part& a = body.add(make_part("a", shape, {}, 1000));
      a.rest({{"a1", axes[0]}, {"a2", axes[1]}, {"a3", axes[2]}}).place({0, 0, 0}, R);
      Part& b = body.add(make_part("b", shape, {}, 1000));
      b.rest({{"a1", axes[1]}, {"a2", axes[2]}, {"a3", axes[0]}}).place(apart * away, R_b);
      body.plane("plane", TimeVector(Vec3<double>(-0.8 * axes.minCoeff() * n)), n);
      body.contact.pairs.push_back({"b", "plane", false});
      return contacts_of(body, most);
    };
    // The closed form measures a gap by the radial material coordinate. At a small depth this gap agrees with
    // the least translation that separates the ellipsoids.
    for (double step = 1; step > 1e-8; step *= 0.5)
      apart += contacts("ellipsoid", -1e-6).size() < 2 ? -step : step;  // one contact is with the plane
    while (contacts("ellipsoid", -1e-6).size() < 2) apart -= 1e-8;
    const std::vector<Contact> found = contacts("ellipsoid", 0), searched = contacts("superellipsoid", 0);
    REQUIRE(found.size() == 2);
    REQUIRE(searched.size() == 2);
    for (std::size_t k = 0; k < 2; ++k) {
      CHECK(found[k].plane == searched[k].plane);
      const double between = (found[k].x - searched[k].x).norm();
      CHECK(between < 1e-5);
      // The inside-outside function f is stationary at the contact. The factor 1 / |grad f|, which converts f
      // to a gap, is not stationary.
      const double tolerance = 1e-9 + 10 * std::abs(found[k].gap) * between;
      CHECK(std::abs(found[k].gap - searched[k].gap) <= tolerance);
      CHECK((found[k].normal - searched[k].normal).norm() < 1e-5);
    }
  }
}

TEST_CASE("faces whose edges coincide to rounding touch at all corners", "[contact]") {
  Draws draws(29);
  auto rounding = [&] { return Vec3<double>(1e-12 * draws.vector(1)); };
  for (int trial = 0; trial < 500; ++trial) {
    // Two thirds of the pairs are upright; for these pairs, rounding decides the order of the corners. The
    // other pairs are rotated.
    const Eigen::Quaterniond R = trial % 3 < 2 ? Eigen::Quaterniond::Identity() : random_rotation(draws);
    // The edges coincide along y. Along x they coincide in every second trial; otherwise the upper box is
    // displaced.
    const double aside = trial % 2 == 0 ? 0 : 0.005;
    MultiBody body;
    body.contact.between_parts = true;
    for (int k = 0; k < 2; ++k) {
      const Vec3<double> angles = rounding();
      body.add(make_part(k == 0 ? "below" : "above", "box", {}, 1000))
          .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
          .place(R * (Vec3<double>(k * aside, 0, 0.2 * k) + rounding()),
                 R * Eigen::Quaterniond(1, angles[0], angles[1], angles[2]).normalized());
    }
    const std::vector<Contact> found = contacts_of(body, 1e-6);
    CAPTURE(trial);
    CHECK(found.size() == 4);
    for (const double x : {aside - 0.1, 0.1})
      for (const double y : {-0.1, 0.1}) {
        const Vec3<double> corner = R * Vec3<double>(x, y, 0.1);
        double nearest = 1;
        for (const Contact& contact : found) nearest = std::min(nearest, (contact.x - corner).norm());
        CHECK(nearest < 1e-6);
      }
  }
}

TEST_CASE("named pairs use their own rules, and joined parts touch only if their pair is named",
          "[contact]") {
  for (const bool between : {true, false})
    for (const bool named : {true, false}) {
      MultiBody body;
      body.contact.active = true;
      body.contact.between_parts = between;
      std::vector<Part*> balls;
      for (int i = 0; i < 3; ++i)  // each part overlaps the next part
        balls.push_back(&body.add(make_part("ball" + std::to_string(i), "sphere", {}, 1000))
                             .rest({{"r", 0.501}})
                             .place({static_cast<double>(i), 0, 0}));
      body.ball("joint", point(*balls[0], 0, 0), point(*balls[1], 0, kPi));
      if (named) body.contact.pairs.push_back({"ball1", "ball0", true, 0.25, 0.75});
      const std::vector<Contact> found = contacts_of(body, 0);
      REQUIRE(found.size() == std::size_t{between} + std::size_t{named});
      for (const Contact& contact : found) {
        CHECK(contact.b.part == contact.a.part + 1);
        CHECK(contact.friction == (contact.a.part == 0 ? 0.25 : body.contact.friction));
      }
    }
}

TEST_CASE("N55: the broad phase finds near boxes of all sizes, each pair once and in order", "[contact]") {
  Draws draws(15);
  for (const int n : {0, 1, 2, 5, 300, 6000}) {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (int i = 0; i < n; ++i) {
      const double size = i % 100 == 7 ? 0.3 : 0.16 * draws.uniform(0, 1);
      const Vec3<double> middle = draws.vector(1);
      boxes.emplace_back(middle.array() - size, middle.array() + size);
    }
    for (const double most : {0.0, 0.01}) {
      BoxTree tree;
      tree.build(boxes);
      std::vector<std::pair<int, int>> pairs, all;
      tree.near_pairs(most, pairs);
      for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j)
          if (boxes[static_cast<std::size_t>(i)].exteriorDistance(boxes[static_cast<std::size_t>(j)]) <= most)
            all.emplace_back(i, j);
      CHECK(pairs == all);
      if (n == 6000) CHECK(pairs.size() > 100000);
    }
  }
}

}  // namespace find_contacts_test
