// Contacts of boxes are compared with closed forms. No direction separates two boxes by more than the
// reported gap.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/collision/box_contacts.h>
#include <pliant/shape/material.h>

#include "draws.h"

namespace box_contacts_test {

using namespace pliant;
using test::Draws;

namespace {

Mat3<double> rotation(double angle, const Vec3<double>& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}
/// Returns the touches of two boxes with gaps of at most `most` (m).
std::vector<BoxTouch> touches(const PlacedBox& a, const PlacedBox& b, double most) {
  std::vector<BoxTouch> found;
  touch_boxes(a, b, most, found);
  return found;
}
double min_gap(const std::vector<BoxTouch>& found) {
  double gap = 1e9;
  for (const BoxTouch& touch : found) gap = std::min(gap, touch.gap);
  return gap;
}
/// Returns the largest value of n . x over a box at the origin, m.
double extent(const PlacedBox& box, const Vec3<double>& n) {
  return (box.R.transpose() * n).cwiseAbs().dot(box.half);
}
const Mat3<double> kUpright = Mat3<double>::Identity();

}  // namespace

TEST_CASE("a box on a box touches at the corners of the common area", "[contact]") {
  const PlacedBox below{{0, 0, 0}, kUpright, {1, 2, 0.5}},
      above{{0.7, 0.3, 0.9 + 1e-4}, kUpright, {1, 1, 0.4}};
  CHECK(touches(above, below, 0.9e-4).empty());
  const std::vector<BoxTouch> found = touches(above, below, 1.1e-4);
  REQUIRE(found.size() == 4);
  for (const BoxTouch& touch : found) {
    CHECK(touch.gap == Approx(1e-4).epsilon(1e-10));
    CHECK((touch.normal - Vec3<double>(0, 0, 1)).norm() < 1e-15);
    CHECK(touch.x[2] == Approx(0.5 + 1e-4));
    CHECK(std::min(std::abs(touch.x[0] + 0.3), std::abs(touch.x[0] - 1)) < 1e-15);
    CHECK(std::min(std::abs(touch.x[1] + 0.7), std::abs(touch.x[1] - 1.3)) < 1e-15);
  }
  const PlacedBox across{{0, 0, 0.9}, rotation(kPi / 4, {0, 0, 1}), {1, 1, 0.4}};
  const PlacedBox square{{0, 0, 0}, kUpright, {1, 1, 0.5}};
  const std::vector<BoxTouch> eight = touches(across, square, 1e-6);
  REQUIRE(eight.size() == 8);
  for (const BoxTouch& touch : eight)
    CHECK(touch.x.head<2>().norm() == Approx(std::hypot(1, std::sqrt(2.0) - 1)));
}

TEST_CASE("crossed edges touch at one point; a box with a corner above a face touches at the corner",
          "[contact]") {
  const double r = std::sqrt(0.5);
  const PlacedBox below{{0, 0, 0}, rotation(kPi / 4, {1, 0, 0}), {2, 0.5, 0.5}},
      above{{0.3, 0.1, 2 * r - 1e-3}, rotation(0.4, {0, 0, 1}) * rotation(kPi / 4, {1, 0, 0}), {2, 0.5, 0.5}};
  const std::vector<BoxTouch> crossed = touches(above, below, 0);
  REQUIRE(crossed.size() == 1);
  CHECK(crossed[0].gap == Approx(-1e-3).epsilon(1e-9));
  CHECK((crossed[0].normal - Vec3<double>(0, 0, 1)).norm() < 1e-12);
  CHECK(crossed[0].x[2] == Approx(r - 1e-3));
  CHECK(crossed[0].x[1] == Approx(0).margin(1e-12));

  const Vec3<double> half(0.3, 0.4, 0.5);
  const Mat3<double> R =
      Eigen::Quaterniond::FromTwoVectors(half, Vec3<double>(0.02, 0.03, -1)).toRotationMatrix();
  const double depth = (R * half)[2];
  const std::vector<BoxTouch> corner =
      touches({{0.2, 0.1, 1 - depth + 2e-3}, R, half}, {{0, 0, 0}, kUpright, {3, 3, 1}}, 3e-3);
  REQUIRE(corner.size() == 1);
  CHECK(corner[0].gap == Approx(2e-3).epsilon(1e-9));
  CHECK((corner[0].x - Vec3<double>(0.2, 0.1, 1 - depth + 2e-3) - R * half).norm() < 1e-12);
}

TEST_CASE("no direction separates boxes by more than their gap, and a swap of the boxes reverses the normal",
          "[contact]") {
  Draws draws(23);
  int overlapping = 0;
  for (int trial = 0; trial < 400; ++trial) {
    auto box = [&] {
      return PlacedBox{draws.vector(0.5),
                       rotation(draws.uniform(0, 6), draws.vector(1)),
                       {draws.uniform(0.1, 0.6), draws.uniform(0.1, 0.6), draws.uniform(0.1, 0.6)}};
    };
    const PlacedBox a = box(), b = box();
    const std::vector<BoxTouch> found = touches(a, b, 10), swapped = touches(b, a, 10);
    REQUIRE(!found.empty());
    REQUIRE(found.size() == swapped.size());
    CHECK(min_gap(found) == Approx(min_gap(swapped)).margin(2e-6));
    CHECK((found[0].normal + swapped[0].normal).norm() < 1e-12);
    for (const BoxTouch& touch : found) {
      CHECK(touch.normal.norm() == Approx(1));
      const Vec3<double> in_a = a.R.transpose() * (touch.x - a.c);
      CHECK((in_a.cwiseAbs() - a.half).maxCoeff() < 1e-12);
    }
    if (min_gap(found) > 0) continue;  // the gap of separated boxes may be less than their distance
    ++overlapping;
    for (int k = 0; k < 200; ++k) {
      const Vec3<double> n = draws.vector(1).normalized();
      CHECK(std::abs(n.dot(b.c - a.c)) - extent(a, n) - extent(b, n) < min_gap(found) + 2e-6);
    }
  }
  CHECK(overlapping > 50);
}

TEST_CASE("a ball touches a box at its nearest point: of a face, an edge or a corner, also from inside",
          "[contact]") {
  const PlacedBox box{{1, 2, 3}, rotation(0.7, {1, 2, -1}), {0.5, 0.4, 0.3}};
  auto touch = [&](const Vec3<double>& in_box) { return touch_ball(box.c + box.R * in_box, 0.2, box); };
  auto check = [&](const Vec3<double>& in_box, const Vec3<double>& normal, double gap) {
    const BoxTouch found = touch(in_box);
    CAPTURE(in_box.transpose());
    CHECK((box.R.transpose() * found.normal - normal.normalized()).norm() < 1e-14);
    CHECK(found.gap == Approx(gap).margin(1e-15));
    CHECK((found.x - (box.c + box.R * (in_box - 0.2 * normal.normalized()))).norm() < 1e-14);
  };
  check({0.8, 0.1, -0.2}, {1, 0, 0}, 0.1);
  check({0.6, 0.1, -0.2}, {1, 0, 0}, -0.1);
  check({0.53, -0.44, 0.1}, {3, -4, 0}, 0.05 - 0.2);
  check({0.51, 0.42, -0.32}, {1, 2, -2}, 0.03 - 0.2);
  check({0.1, 0.1, -0.25}, {0, 0, -1}, -0.05 - 0.2);
  check({0.5, 0.1, 0.1}, {1, 0, 0}, -0.2);
  // The contact point on the box is the point nearest to the ball. For a centre inside the box, the normal is
  // along the shortest way out.
  Draws draws(9);
  for (int i = 0; i < 200; ++i) {
    const Vec3<double> at(draws.uniform(-0.8, 0.8), draws.uniform(-0.7, 0.7), draws.uniform(-0.6, 0.6));
    const BoxTouch found = touch(at);
    if (((at.cwiseAbs() - box.half).array() < 0).all()) {
      CHECK(found.gap == Approx(-(box.half - at.cwiseAbs()).minCoeff() - 0.2).margin(1e-14));
      CHECK(found.normal.dot(box.R * at) > 0);
      continue;
    }
    const Vec3<double> x = box.R.transpose() * (found.x - box.c),
                       on_box = x - found.gap * (box.R.transpose() * found.normal);
    CHECK(((on_box.cwiseAbs() - box.half).array() < 1e-14).all());
    for (int k = 0; k < 20; ++k) {
      const Vec3<double> inside(draws.uniform(-0.5, 0.5), draws.uniform(-0.4, 0.4), draws.uniform(-0.3, 0.3));
      CHECK((at - inside).norm() - 0.2 >= found.gap - 1e-14);
    }
  }
}

}  // namespace box_contacts_test
