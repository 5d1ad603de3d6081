// Slender and ruled solids on a plane, with length to thickness of 10, 100 and 1000: they come to rest when
// they are dropped, roll at a constant speed, and topple in the plane of symmetry of the scene.
#include "catch.h"

#include <cmath>
#include <string>
#include <vector>

#include <pliant/contact/contact_stepping.h>

#include "motion.h"
#include "worst.h"

namespace slender_solids_test {

using namespace pliant;
using test::Worst;

namespace {

/// A solid of length 1 m along z.
struct Kind {
  const char *name, *shape;
  bool rolls;                     ///< a solid of revolution that rolls straight on
  Part::Named (*rest)(double r);  ///< r: radius, m
};
Part::Named half_sizes(double r) {
  return {{"a1", r}, {"a2", r}, {"a3", 0.5}};
}
Part::Named capsule(double r) {
  return {{"r", r}, {"l", 1 - 2 * r}};
}
Part::Named frustum(double r) {
  return {{"a1", r}, {"a2", r}, {"a3", 0.5}, {"t", 0.3}};
}
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{{"cylinder", "cylinder", true, half_sizes},
                                     {"capsule", "capsule", true, capsule},
                                     {"frustum", "cone", false, frustum},
                                     {"box", "box", false, half_sizes}};
  return all;
}

Eigen::Quaterniond rotation_about(double angle, const Vec3<double>& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

/// Returns the lowest height of a part (m, world) whose frame is at the origin. R: orientation of the part.
double lowest(const Part& part, const Eigen::Quaterniond& R) {
  const ParameterValues<double> values = part.parameters().rest();
  const Vec3<double> down = R.inverse() * Vec3<double>(0, 0, -1);
  double depth = 0;
  for (int piece = 0; piece < part.shape().hull_pieces(); ++piece)
    depth = std::max(depth, down.dot(part.shape().support(down, values.b.data(), piece)));
  return -depth;
}

}  // namespace

TEST_CASE("slender solids that are dropped on a plane at an angle come to rest on it", "[contact]") {
  for (const Kind& kind : kinds())
    for (const double r : {0.05, 5e-3, 5e-4})
      for (const double angle : {1e-4, 0.05, 0.6}) {
        CAPTURE(kind.name, r, angle);
        MultiBody body;
        body.contact.friction = 0.5;
        body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
        Part& part = test::add(body, "a", kind.shape, {}, 1000).rest(kind.rest(r));
        const Eigen::Quaterniond R = rotation_about(kPi / 2 - angle, Vec3<double>::UnitY());
        part.place({0, 0, 0.01 - lowest(part, R)}, R);
        Simulation simulation(body, "rk4");
        test::run(simulation, 4, 2000);
        CHECK(simulation.state().v.norm() < 1e-6);
        // The scene is symmetric: the solid does not move along y, and rotates only about y.
        CHECK(std::abs(simulation.state().q[1]) < 1e-8);
        CHECK(std::hypot(simulation.state().q[4], simulation.state().q[6]) < 1e-8);
        const Eigen::Quaterniond end(simulation.state().q[3], simulation.state().q[4],
                                     simulation.state().q[5], simulation.state().q[6]);
        CHECK(std::abs(simulation.state().q[2] + lowest(part, end)) < 1e-6);
      }
}

TEST_CASE("slender solids of revolution roll on a plane at a constant speed", "[contact]") {
  for (const Kind& kind : kinds())
    for (const double r : {0.05, 5e-3, 5e-4}) {
      if (!kind.rolls) continue;
      CAPTURE(kind.name, r);
      MultiBody body;
      body.contact.friction = 0.5;
      body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
      Part& part = test::add(body, "a", kind.shape, {}, 1000).rest(kind.rest(r));
      part.place({0, 0, r}, rotation_about(-kPi / 2, Vec3<double>::UnitX()));
      const double speed = 10 * r;  // 10 rad/s; the z axis of the part is the y axis of the world
      part.velocity({speed, 0, 0}, {0, 0, speed / r});
      Simulation simulation(body, "rk4");
      Worst speed_error, height;
      for (int i = 0; i < 400; ++i) {
        simulation.step(5e-3);
        speed_error.note(std::abs(simulation.state().v[0] / speed - 1));
        height.note(std::abs(simulation.state().q[2] / r - 1));
      }
      CHECK(speed_error < 1e-9);
      CHECK(height < 1e-9);
    }
}

TEST_CASE("slender solids topple in the plane in which they lean", "[contact]") {
  for (const Kind& kind : kinds())
    for (const double r : {0.05, 5e-3, 5e-4}) {
      CAPTURE(kind.name, r);
      MultiBody body;
      body.contact.friction = 1;
      body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
      Part& part = test::add(body, "a", kind.shape, {}, 1000).rest(kind.rest(r));
      const Eigen::Quaterniond R = rotation_about(0.2, Vec3<double>::UnitY());
      part.place({0, 0, -lowest(part, R)}, R);
      Simulation simulation(body, "rk4");
      Worst aside, aside_at_rest;
      for (int i = 0; i < 750; ++i) {
        simulation.step(2e-3);
        const VecX<double>& v = simulation.state().v;
        const bool lies = simulation.state().q[2] < 2 * r;
        (lies ? aside_at_rest : aside).note(std::max({std::abs(v[1]), std::abs(v[3]), std::abs(v[5])}));
      }
      CHECK(aside < 1e-9);
      CHECK(aside_at_rest < 1e-6);
      CHECK(simulation.state().q[2] < 2 * r);  // the solid lies on its side
    }
}

TEST_CASE(
    "slender rods that are bent, tapered or twisted fall on a plane and come to rest, or roll and rock "
    "there, with a small balance error",
    "[contact][long]") {
  struct Rod {
    const char *shape, *link, *parameter;
    double value;
    Part::Named (*rest)(double r);
  };
  const std::vector<Rod> rods{{"capsule", "bend", "bend.angle", 0.5, capsule},
                              {"cylinder", "bend", "bend.angle", 0.5, half_sizes},
                              {"cylinder", "taper", "taper.tx", 0.3, half_sizes},
                              {"box", "bend", "bend.angle", 0.5, half_sizes},
                              {"box", "twist", "twist.angle", 0.5, half_sizes}};
  for (const Rod& rod : rods)
    for (const double r : {0.05, 5e-3, 5e-4})
      for (const double angle : {0.05, 0.6}) {
        CAPTURE(rod.shape, rod.link, r, angle);
        MultiBody body;
        body.contact.friction = 0.5;
        body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
        Part& part = test::add(body, "a", rod.shape, {rod.link}, 1000).rest(rod.rest(r));
        part.rest({{rod.parameter, rod.value}});
        part.place({0, 0, 0.4}, rotation_about(kPi / 2 - angle, Vec3<double>(0.1, 1, 0).normalized()));
        Simulation simulation(body, "rk4");
        const double before = simulation.ledger().energy();
        test::run(simulation, 3, 1500);
        const Ledger middle = simulation.ledger();
        test::run(simulation, 3, 1500);
        const Ledger after = simulation.ledger();
        // Errors of resting contact are of first order. Bent rods come to rest; other rods may roll on.
        CHECK(std::abs(middle.balance) < 0.03 * before);
        CHECK(std::abs(after.balance - middle.balance) < 1e-4 * before);
        if (std::string(rod.link) == "bend") CHECK(simulation.state().v.norm() < 1e-14);
        double lowest = 1;
        for (const Contact& contact : ContactFinder(simulation.model()).find(simulation.state(), 0, 0.1))
          lowest = std::min(lowest, contact.gap);
        CHECK(std::abs(lowest) < 1e-6);
      }
}

}  // namespace slender_solids_test
