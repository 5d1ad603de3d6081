// Contacts of pairs of convex parts. The gap is the largest separation over all normals, and does not depend
// on the order of the parts. The contact points are in both parts to within the gap.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/collision/find_contacts.h>
#include <pliant/part/registry.h>

#include "draws.h"
#include "solid_kind.h"
#include "worst.h"

namespace convex_pairs_test {

using namespace pliant;
using test::Draws;
using test::random_rotation;
using test::Worst;
using Kind = test::SolidKind;

namespace {

/// Returns a superquadric with fixed semi-axes and the given exponents.
Kind superquadric(const char* name, const char* shape, double eps1, double eps2) {
  return {name, shape, {}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.05}, {"eps1", eps1}, {"eps2", eps2}}};
}
const std::vector<Kind>& kinds() {
  const Part::Named axes{{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.05}};
  const Part::Named cylinder{{"a1", 0.06}, {"a2", 0.05}, {"a3", 0.1}};
  auto with = [&](const char* name, double value) {
    Part::Named rest = cylinder;
    rest.emplace_back(name, value);
    return rest;
  };
  static const std::vector<Kind> all{
      {"ellipsoid", "ellipsoid", {}, axes},
      superquadric("round superellipsoid", "superellipsoid", 0.8, 1.2),
      superquadric("square superellipsoid", "superellipsoid", 0.3, 0.4),
      superquadric("box-like superellipsoid", "superellipsoid", 0.1, 0.1),
      superquadric("pointed superellipsoid", "superellipsoid_radial", 1.7, 1.5),
      {"cylinder", "cylinder", {}, cylinder},
      {"cone", "cone", {}, with("t", -1)},
      {"frustum", "cone", {}, with("t", 0.4)},
      {"capsule", "capsule", {}, {{"r", 0.04}, {"l", 0.12}}},
      {"sheared cylinder", "cylinder", {"shear"}, with("shear.sx", 0.5)},
      {"box", "box", {}, axes}};
  return all;
}

/// Two parts. Part a is at the origin, part b at to_b (m).
struct Pair {
  MultiBody body;
  Pair(const Kind& a, const Kind& b, const Eigen::Quaterniond& R_a, const Eigen::Quaterniond& R_b,
       const Vec3<double>& to_b) {
    body.contact.between_parts = true;
    body.add(make_part("a", a.shape, a.chain, 1000)).rest(a.rest).place({0, 0, 0}, R_a);
    body.add(make_part("b", b.shape, b.chain, 1000)).rest(b.rest).place(to_b, R_b);
  }
  std::vector<Contact> contacts(double max_gap) {
    const Model model(body);
    return ContactFinder(model).find(model.initial_state(), 0, max_gap);
  }
};

/// Returns the support function (metres) of a part at the origin, from its parameters. m: direction, body
/// frame.
double support(const Part& part, const Vec3<double>& m) {
  const ParameterValues<double> values = part.parameters().rest();
  const double shear = part.parameters().find("shear.sx") >= 0 ? 0.5 : 0.0;
  const Vec3<double> pulled(m[0], m[1], m[2] + shear * m[0]);  // F^T m; F: matrix of the shear
  double h = -std::numeric_limits<double>::infinity();
  for (int piece = 0; piece < part.shape().hull_pieces(); ++piece)
    h = std::max(h,
                 pulled.dot(part.shape().support(Vec3<double>(pulled.normalized()), values.b.data(), piece)));
  return h;
}

/// Returns the separation of a pair along a normal.
double separation(const Pair& pair, const Eigen::Quaterniond& R_a, const Eigen::Quaterniond& R_b,
                  const Vec3<double>& to_b, const Vec3<double>& n) {
  const Part &a = *pair.body.parts()[0], &b = *pair.body.parts()[1];
  return -n.dot(to_b) - support(a, R_a.inverse() * Vec3<double>(-n)) - support(b, R_b.inverse() * n);
}

}  // namespace

TEST_CASE("the gap of convex parts is the largest separation over all normals", "[contact][long]") {
  Draws draws(7);
  for (const Kind& kind_a : kinds())
    for (const Kind& kind_b : kinds()) {
      // Pairs of ellipsoids and pairs of boxes have closed forms, which measure the gap in other ways.
      const bool has_closed_form = &kind_a == &kind_b && (kind_a.shape == std::string("ellipsoid") ||
                                                          kind_a.shape == std::string("box"));
      if (&kind_a > &kind_b || has_closed_form) continue;
      CAPTURE(kind_a.name, kind_b.name);
      Worst value, better, outside, order;
      for (int trial = 0; trial < 20; ++trial) {
        const Eigen::Quaterniond R_a = random_rotation(draws), R_b = random_rotation(draws);
        const Vec3<double> to_b = draws.uniform(0.02, 0.25) * draws.vector(1).normalized();
        Pair pair(kind_a, kind_b, R_a, R_b, to_b);
        auto s = [&](const Vec3<double>& n) { return separation(pair, R_a, R_b, to_b, n); };
        const std::vector<Contact> found = pair.contacts(1);
        REQUIRE(!found.empty());
        double gap = 1;
        for (const Contact& contact : found) gap = std::min(gap, contact.gap);
        const Vec3<double> normal = found[0].normal;
        CAPTURE(trial, gap, normal.transpose());
        value.note(std::abs(gap - s(normal)));
        // Contact points are inside both parts, or outside by at most the gap. The gap does not depend on the
        // order.
        for (const Contact& contact : found)
          for (int i = 0; i < 50 && gap > -0.01; ++i) {
            const Vec3<double> m = draws.vector(1).normalized();
            outside.note(m.dot(contact.x) - support(*pair.body.parts()[0], R_a.inverse() * m) -
                         std::abs(contact.gap));
            outside.note(m.dot(contact.x - to_b) - support(*pair.body.parts()[1], R_b.inverse() * m) -
                         std::abs(contact.gap));
          }
        Pair swapped(kind_b, kind_a, R_b, R_a, -to_b);
        double swapped_gap = 1;
        for (const Contact& contact : swapped.contacts(1)) swapped_gap = std::min(swapped_gap, contact.gap);
        if (gap > -0.01) order.note(std::abs(swapped_gap - gap));
        // In a shallow overlap the separation has one maximum over the normals. In a deep overlap it has
        // several maxima, and the search starts from 13 normals only.
        double best = gap;
        for (int i = 0; i < 1000; ++i) best = std::max(best, s(draws.vector(1).normalized()));
        CHECK(best - gap <= (gap < -0.01 ? -0.3 * gap : 1e-8));
        for (double width = 0.03; width > 1e-9; width *= 0.5)
          for (int i = 0; i < 8; ++i) better.note(s((normal + draws.vector(width)).normalized()) - gap);
      }
      CHECK(value < 1e-12);
      CHECK(better < 1e-8);
      // In nearly flat regions the place of the contact depends on the last digits of the normal.
      const bool is_flat = kind_a.name == std::string("box-like superellipsoid") ||
                           kind_b.name == std::string("box-like superellipsoid");
      CHECK(outside < (is_flat ? 1e-3 : 1e-6));
      CHECK(order < 1e-8);
    }
}

TEST_CASE("end faces in one plane touch where they overlap, and are apart where they do not", "[contact]") {
  // A coin lies beside a block; their upper and lower faces are in one plane.
  for (const double overlap : {0.05, 0.01, -0.02}) {
    CAPTURE(overlap);
    MultiBody body;
    body.contact.between_parts = true;
    body.add(make_part("coin", "cylinder", {}, 1000)).rest({{"a1", 1}, {"a2", 1}, {"a3", 0.1}});
    body.add(make_part("block", "box", {}, 1000))
        .rest({{"a1", 0.3}, {"a2", 0.3}, {"a3", 0.1}})
        .place({1.3 - overlap, 0, 0.2});
    const Model model(body);
    const std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, 1e-3);
    if (overlap < 0) {
      CHECK(found.empty());
      continue;
    }
    REQUIRE(!found.empty());
    for (const Contact& contact : found) {
      CHECK(std::abs(contact.gap) < 1e-12);
      CHECK(std::abs(contact.normal[2]) > 1 - 1e-12);
      CHECK(contact.x.head<2>().norm() < 1 + 1e-9);
      CHECK(contact.x[0] > 1 - overlap - 0.08);  // an octagon represents the rim of the coin
    }
  }
}

TEST_CASE("stacked parts with flat faces touch at four points or more, symmetrically", "[contact]") {
  for (const std::string shape : {"cylinder", "superellipsoid"}) {
    CAPTURE(shape);
    MultiBody body;
    body.contact.between_parts = true;
    Part::Named rest{{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}};
    if (shape == "superellipsoid") {
      rest.push_back({"eps1", 0.1});
      rest.push_back({"eps2", 0.1});
    }
    body.add(make_part("below", shape, {}, 1000)).rest(rest);
    body.add(make_part("above", shape, {}, 1000)).rest(rest).place({0, 0, 0.2});
    const Model model(body);
    const std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, 1e-7);
    REQUIRE(found.size() >= 4);
    Vec3<double> middle = Vec3<double>::Zero();
    for (const Contact& contact : found) middle += contact.x / static_cast<double>(found.size());
    CHECK(middle.head<2>().norm() < 1e-9);
    for (const Contact& contact : found) CHECK(std::abs(contact.gap) < 1e-7);
  }
}

TEST_CASE("a can that leans on a table touches it with its lowest point, in all directions", "[contact]") {
  for (const double tilt : {1e-3, 0.01, 0.1})
    for (int k = 0; k < 24; ++k) {
      CAPTURE(tilt, k);
      const Vec3<double> axis(std::cos(0.3 * k), std::sin(0.3 * k), 0);
      const Eigen::Quaterniond R(Eigen::AngleAxisd(tilt, axis));
      MultiBody body;
      body.contact.between_parts = true;
      body.add(make_part("table", "box", {}, 1000)).rest({{"a1", 1}, {"a2", 1}, {"a3", 0.1}});
      body.add(make_part("can", "cylinder", {}, 1000))
          .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
          .place({0, 0, 0.1 + 0.1 * (std::cos(tilt) + std::sin(tilt))}, R);
      const Model model(body);
      const std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, 1e-7);
      REQUIRE(!found.empty());
      const auto lowest = std::min_element(found.begin(), found.end(),
                                           [](const Contact& a, const Contact& b) { return a.gap < b.gap; });
      CHECK(std::abs(lowest->gap) < 1e-12);
      const Vec3<double> down = R.inverse() * Vec3<double>(0, 0, -1);
      const Vec3<double> rim(0.1 * down[0] / down.head<2>().norm(), 0.1 * down[1] / down.head<2>().norm(),
                             -0.1);
      const Vec3<double> expected = R * rim;
      CHECK((lowest->x.head<2>() - expected.head<2>()).norm() < 1e-9);
    }
}

TEST_CASE("the best of several local maxima is found for cylinders whose rims overlap", "[contact]") {
  const Kind cylinder{"cylinder", "cylinder", {}, {{"a1", 0.06}, {"a2", 0.06}, {"a3", 0.09}}};
  const Eigen::Quaterniond R_a(-0.36556593, 0.63943188, -0.26334756, -0.62300600),
      R_b(0.05253304, -0.40056294, 0.55837079, -0.72457689);
  Pair pair(cylinder, cylinder, R_a.normalized(), R_b.normalized(), {-0.12809975, 0.11608806, 0.10930347});
  const std::vector<Contact> found = pair.contacts(0);
  REQUIRE(!found.empty());
  double gap = 0;
  for (const Contact& contact : found) gap = std::min(gap, contact.gap);
  CHECK(std::abs(gap + 0.00649) < 1e-5);  // from dense sampling of the normals
}

}  // namespace convex_pairs_test
