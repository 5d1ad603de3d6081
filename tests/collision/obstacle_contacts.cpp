// Contacts of solids with obstacle meshes: on flat faces they are those with planes, and on a ridge the
// contact is the deepest point of the ridge.
#include "catch.h"

#include <algorithm>
#include <cmath>

#include <pliant/collision/find_contacts.h>
#include <pliant/part/registry.h>

#include "draws.h"
#include "solid_kind.h"

namespace obstacle_contacts_test {

using namespace pliant;
using test::Draws;
using test::random_rotation;
using Kind = test::SolidKind;

namespace {

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"ellipsoid", "ellipsoid", {}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}}},
      {"box", "box", {}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}}},
      {"cylinder", "cylinder", {}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}}},
      {"cone", "cone", {}, {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}, {"t", -0.5}}},
      {"capsule", "capsule", {}, {{"r", 0.05}, {"l", 0.3}}},
      {"superellipsoid",
       "superellipsoid",
       {},
       {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"eps1", 0.5}, {"eps2", 1.2}}},
      {"supertoroid", "supertoroid", {}, {{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.05}, {"a4", 3}}},
      {"sheared cylinder",
       "cylinder",
       {"shear"},
       {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"shear.sx", 0.4}}},
      {"tapered ellipsoid",
       "ellipsoid",
       {"taper"},
       {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"taper.tx", 0.5}}},
      {"twisted box", "box", {"twist"}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"twist.angle", 0.8}}},
      {"bent capsule", "capsule", {"bend"}, {{"r", 0.04}, {"l", 0.2}, {"bend.angle", 0.8}}}};
  return all;
}

/// Makes a body of one part at c (m) with the orientation R.
void make(MultiBody& body, const Kind& kind, const Vec3<double>& c, const Eigen::Quaterniond& R) {
  body.add(make_part("part", kind.shape, kind.chain, 1000)).rest(kind.rest).place(c, R);
}

constexpr double kOnePoint = 1e-6;  ///< distance between points that are one, m

/// Returns the contacts with a gap of at most max_gap (m), in the order of their x and y coordinates and of
/// their normals.
std::vector<Contact> sorted_contacts(MultiBody& body, double max_gap) {
  const Model model(body);
  std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, max_gap);
  std::sort(found.begin(), found.end(), [](const Contact& one, const Contact& other) {
    const Vec3<double> apart = one.x - other.x;
    for (int k = 0; k < 2; ++k)
      if (std::abs(apart[k]) > kOnePoint) return apart[k] < 0;
    return one.normal[0] < other.normal[0];  // a corner in a groove touches both faces
  });
  return found;
}

/// Returns the distance (m) by which a part with its frame at the origin extends in the direction -n.
double extent(const Kind& kind, const Eigen::Quaterniond& R, const Vec3<double>& n) {
  constexpr double far = 10;
  MultiBody body;
  make(body, kind, Vec3<double>::Zero(), R);
  body.plane("plane", TimeVector(-far * n), n);
  double least = far;
  for (const Contact& contact : sorted_contacts(body, far)) least = std::min(least, contact.gap);
  return far - least;
}

/// Checks that the contacts with an obstacle are those with planes.
void check_equal(const std::vector<Contact>& on_mesh, const std::vector<Contact>& on_planes, double size) {
  REQUIRE(on_mesh.size() == on_planes.size());
  for (std::size_t k = 0; k < on_mesh.size(); ++k) {
    CHECK((on_mesh[k].x - on_planes[k].x).norm() < 1e-12 * size);
    CHECK((on_mesh[k].normal - on_planes[k].normal).norm() < 1e-14);
    CHECK(std::abs(on_mesh[k].gap - on_planes[k].gap) < 1e-13 * size);
  }
}

}  // namespace

TEST_CASE("the contacts of a solid with a groove are those with two planes, and with a floor those with one",
          "[contact]") {
  constexpr double depth = 1e-5, max_gap = 1e-4, wide = 3;  // m
  Draws draws(31);
  for (const Kind& kind : kinds())
    for (int trial = 0; trial < 40; ++trial) {
      CAPTURE(kind.name, trial);
      // The faces of the groove rise to both sides of the y axis by this angle; without it they are one
      // floor.
      const double rise = trial % 2 == 0 ? 0 : draws.uniform(0.3, 1);
      const Eigen::Quaterniond R = random_rotation(draws);
      const Vec3<double> right(-std::sin(rise), 0, std::cos(rise)), left(std::sin(rise), 0, std::cos(rise));
      const double above_right = extent(kind, R, right) - depth, above_left = extent(kind, R, left) - depth;
      Vec3<double> c(0, 0, above_right);
      if (rise > 0)
        c << (above_left - above_right) / (2 * std::sin(rise)), 0,
            (above_left + above_right) / (2 * std::cos(rise));
      MultiBody on_planes, on_mesh;
      make(on_planes, kind, c, R);
      make(on_mesh, kind, c, R);
      on_planes.plane("right", Vec3<double>(0, 0, 0), right);
      if (rise > 0) on_planes.plane("left", Vec3<double>(0, 0, 0), left);
      Eigen::Matrix3Xd x(3, 6);
      const double height = wide * std::tan(rise);
      x.col(0) << -wide, -wide, height;
      x.col(1) << -wide, wide, height;
      x.col(2) << 0, -wide, 0;
      x.col(3) << 0, wide, 0;
      x.col(4) << wide, -wide, height;
      x.col(5) << wide, wide, height;
      Eigen::Matrix3Xi triangles(3, 4);
      triangles << 0, 1, 2, 3,  //
          2, 2, 4, 4,           //
          1, 3, 3, 5;
      on_mesh.obstacle("groove", x, triangles);
      check_equal(sorted_contacts(on_mesh, max_gap), sorted_contacts(on_planes, max_gap),
                  on_mesh.parts()[0]->size());
    }
}

TEST_CASE("one tip of a hook touches a table while the other tip is below the table top, beside it",
          "[contact]") {
  constexpr double radius = 0.04, depth = 1e-5, lower = 0.06, to_edge = 0.04, far = 1;  // m
  const Kind hook{"hook", "capsule", {"bend"}, {{"r", radius}, {"l", 0.2}, {"bend.angle", 1.25}}};
  MultiBody probe;
  make(probe, hook, Vec3<double>::Zero(), Eigen::Quaterniond::Identity());
  const Part& part = *probe.parts()[0];
  const Eigen::Matrix3Xd places =
      part.s({material_at(kPi / 2, 0, 1), material_at(-kPi / 2, 0, 1), material_at(0, 0, 0)},
             part.parameters().rest());
  const Vec3<double> tip_to_tip = places.col(1) - places.col(0), along = tip_to_tip.normalized();
  const Vec3<double> middle = places.col(2) - 0.5 * (places.col(0) + places.col(1));
  const Vec3<double> up = (middle - along.dot(middle) * along).normalized();
  // The second tip is lower than the first by the length `lower`.
  const double turn = std::asin(lower / tip_to_tip.norm());
  Mat3<double> body, world;
  body << along, up, along.cross(up);
  world << std::cos(turn), std::sin(turn), 0, 0, 0, -1, -std::sin(turn), std::cos(turn), 0;
  const Eigen::Quaterniond R(Mat3<double>(world * body.transpose()));

  MultiBody over_plane;
  make(over_plane, hook, Vec3<double>::Zero(), R);
  over_plane.plane("plane", TimeVector(Vec3<double>(0, 0, -far)), {0, 0, 1});
  const std::vector<Contact> tips = sorted_contacts(over_plane, 2 * far);
  REQUIRE(tips.size() == 2);
  // The depth of the second tip below the face exceeds the largest depth of a contact, half the thickness.
  CHECK(tips[0].gap - tips[1].gap > 1.1 * radius);

  const double edge = tips[0].x[0] + to_edge, top = tips[0].gap - far + depth;
  Eigen::Matrix3Xd x(3, 4);
  x << edge - far, edge, edge, edge - far,  //
      -far, -far, far, far,                 //
      top, top, top, top;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 2, 2, 3;
  MultiBody over_table;
  make(over_table, hook, Vec3<double>::Zero(), R);
  over_table.obstacle("table", x, triangles);
  const std::vector<Contact> found = sorted_contacts(over_table, 0);
  REQUIRE(found.size() == 1);
  CHECK(found[0].gap == Approx(-depth).epsilon(1e-6));
  CHECK((found[0].normal - Vec3<double>::UnitZ()).norm() < 1e-12);
  CHECK((found[0].x - tips[0].x).norm() < 1e-9);
}

TEST_CASE("the contact of a solid with a ridge is the point of the ridge that is deepest in the solid",
          "[contact]") {
  constexpr double wide = 3, level_there = -1e-3;
  constexpr int trials = 20;
  Eigen::Matrix3Xd x(3, 6);  // the ridge is on the y axis
  x << -1, -1, 0, 0, 1, 1,   //
      -1, 1, -1, 1, -1, 1,   //
      -2, -2, 0, 0, -2, -2;
  x *= wide;
  Eigen::Matrix3Xi triangles(3, 4);
  triangles << 0, 0, 2, 2,  //
      2, 3, 4, 5,           //
      3, 1, 5, 3;
  Draws draws(32);
  for (const Kind& kind : kinds()) {
    int on_ridge = 0;
    for (int trial = 0; trial < trials; ++trial) {
      CAPTURE(kind.name, trial);
      const Eigen::Quaterniond R = random_rotation(draws);
      MultiBody alone;
      make(alone, kind, Vec3<double>::Zero(), R);
      const Part& part = *alone.parts()[0];
      const ParameterValues<double> values = part.parameters().rest();
      // f = w - 1 at a point of the ridge, for a frame at the height z; w: radial material coordinate.
      auto level = [&](double y, double z) {
        return part.inside_outside(R.conjugate() * Vec3<double>(0, y, -z), values);
      };
      double below = 0, above = 1;  // heights between which the solid touches the ridge, m
      while (above - below > 1e-12) {
        const double middle = 0.5 * (below + above);
        double least = 1;
        for (double y = -0.5; y < 0.5; y += 0.002) least = std::min(least, level(y, middle));
        (least < level_there ? below : above) = middle;
      }
      MultiBody body;
      make(body, kind, {0, 0, below}, R);
      body.obstacle("ridge", x, triangles);
      for (const Contact& contact : sorted_contacts(body, 1e-4)) {
        if (contact.x.cwiseProduct(Vec3<double>(1, 0, 1)).norm() > 1e-12) continue;  // on a face
        ++on_ridge;
        CHECK(std::abs(contact.normal[1]) < 2e-3);
        for (const double step : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2})
          for (const double side : {-1.0, 1.0})
            CHECK(level(contact.x[1], below) <= level(contact.x[1] + side * step, below) + 1e-9);
      }
    }
    CAPTURE(kind.name, on_ridge);
    CHECK(on_ridge > trials / 2);
  }
}

}  // namespace obstacle_contacts_test
