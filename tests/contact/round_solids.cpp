// Contact of cylinders, cones, tori and capsules, and of tapered, bent and sheared solids: they are stable on
// planes and on each other, slide and roll by the closed forms, and come to rest when they are dropped.
#include "catch.h"

#include <cmath>
#include <functional>
#include <string>

#include <pliant/contact/contact_stepping.h>
#include <pliant/part/mesh/surface.h>

#include "draws.h"
#include "motion.h"
#include "worst.h"

namespace round_solids_test {

using namespace pliant;
using test::Draws;
using test::Worst;

namespace {

constexpr double kG = 9.81;  // m/s^2

Part& cylinder(MultiBody& body, const std::string& name, double radius, double half_height) {
  return test::add(body, name, "cylinder", {}, 1000)
      .rest({{"a1", radius}, {"a2", radius}, {"a3", half_height}});
}
/// Adds a cone or frustum 0.3 m high, with radius 0.1 m at half height. slope: the parameter t; -1 is a cone
/// with its tip up, 1 a cone with its tip down.
Part& cone(MultiBody& body, const std::string& name, double slope) {
  return test::add(body, name, "cone", {}, 1000).rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}, {"t", slope}});
}
Part& torus(MultiBody& body, const std::string& name, double tube, double ring) {
  return test::add(body, name, "supertoroid", {}, 1000)
      .rest({{"a1", tube}, {"a2", tube}, {"a3", tube}, {"a4", ring / tube}});
}
Part& capsule(MultiBody& body, const std::string& name, double radius, double length) {
  return test::add(body, name, "capsule", {}, 1000).rest({{"r", radius}, {"l", length}});
}
/// Adds a box 0.2 m wide and 0.3 m high with a deformation, standing on its end.
void deformed_box(MultiBody& body, const std::string& link, const Part::Named& by) {
  test::add(body, "a", "box", {link}, 1000)
      .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}})
      .rest(by)
      .place({0, 0, 0.15});
}
Eigen::Quaterniond rotation_about(double angle, const Vec3<double>& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}
/// Returns the orientation in which the z axis of a part is along the x axis of the world.
Eigen::Quaterniond lying_on_side() {
  return rotation_about(kPi / 2, Vec3<double>::UnitY());
}
void floor(MultiBody& body) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}

}  // namespace

TEST_CASE(
    "cylinders, cones, tori and capsules are stable on a plane and on each other, with the correct contact "
    "force",
    "[contact]") {
  struct Case {
    const char* name;
    std::function<void(MultiBody&)> build;
    double displacement;  // bound of the displacement, m
  };
  const double tip = std::atan(2.0 / 3);  // half the opening angle of a cone
  const std::vector<Case> cases{
      {"cylinder",
       [](MultiBody& body) {
         cylinder(body, "a", 0.1, 0.15).place({0, 0, 0.15});
       },
       1e-13},
      {"lying cylinder",
       [](MultiBody& body) {
         cylinder(body, "a", 0.1, 0.15).place({0, 0, 0.1}, lying_on_side());
       },
       1e-12},
      {"cone",
       [](MultiBody& body) {
         cone(body, "a", -1).place({0, 0, 0.15});
       },
       1e-13},
      {"frustum",
       [](MultiBody& body) {
         cone(body, "a", -0.4).place({0, 0, 0.15});
       },
       1e-13},
      {"frustum, wide end up",
       [](MultiBody& body) {
         cone(body, "a", 0.4).place({0, 0, 0.15});
       },
       1e-13},
      {"lying cone",
       [&](MultiBody& body) {
         cone(body, "a", -1)
             .place({0, 0, 0.15 * std::sin(tip)},
                    rotation_about(tip, Vec3<double>::UnitY()) * lying_on_side());
       },
       3e-8},
      {"torus",
       [](MultiBody& body) {
         torus(body, "a", 0.05, 0.15).place({0, 0, 0.05});
       },
       1e-13},
      {"upright torus",
       [](MultiBody& body) {
         torus(body, "a", 0.05, 0.15).place({0, 0, 0.2}, rotation_about(kPi / 2, Vec3<double>::UnitX()));
       },
       1e-12},
      {"capsule",
       [](MultiBody& body) {
         capsule(body, "a", 0.1, 0.3).place({0, 0, 0.1}, lying_on_side());
       },
       1e-13},
      {"tapered box",
       [](MultiBody& body) {
         deformed_box(body, "taper", {{"taper.tx", -0.4}});
       },
       1e-13},
      {"sheared box",
       [](MultiBody& body) {
         deformed_box(body, "shear", {{"shear.sx", 0.3}});
       },
       1e-13},
      {"twisted box",
       [](MultiBody& body) {
         deformed_box(body, "twist", {{"twist.angle", 0.5}});
       },
       1e-13},
      {"cylinder on cylinder",
       [](MultiBody& body) {
         cylinder(body, "a", 0.1, 0.15).place({0, 0, 0.15});
         cylinder(body, "b", 0.08, 0.1).place({0.01, 0, 0.4});
       },
       1e-13},
      {"cone on cylinder",
       [](MultiBody& body) {
         cylinder(body, "a", 0.25, 0.1).place({0, 0, 0.1});
         cone(body, "b", -1).place({0.01, 0, 0.35});
       },
       1e-13},
      {"torus on cylinder",
       [](MultiBody& body) {
         cylinder(body, "a", 0.3, 0.1).place({0, 0, 0.1});
         torus(body, "b", 0.05, 0.15).place({0.01, 0, 0.25});
       },
       1e-13},
      {"torus on torus",
       [](MultiBody& body) {
         torus(body, "a", 0.05, 0.15).place({0, 0, 0.05});
         torus(body, "b", 0.05, 0.15).place({0, 0, 0.15});
       },
       1e-13},
      {"box on lying cylinders",
       [](MultiBody& body) {
         const Eigen::Quaterniond across = rotation_about(kPi / 2, Vec3<double>::UnitX());
         cylinder(body, "a", 0.1, 0.15).place({-0.15, 0, 0.1}, across);
         cylinder(body, "b", 0.1, 0.15).place({0.15, 0, 0.1}, across);
         test::add(body, "c", "box", {}, 1000)
             .rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.05}})
             .place({0, 0, 0.25});
       },
       1e-13},
      {"lying cylinders across each other",
       [](MultiBody& body) {
         cylinder(body, "a", 0.2, 0.3).place({0, 0, 0.2}, rotation_about(kPi / 2, Vec3<double>::UnitX()));
         cylinder(body, "b", 0.1, 0.3).place({0, 0, 0.5}, lying_on_side());
       },
       1e-12}};
  for (const Case& tested : cases) {
    CAPTURE(tested.name);
    MultiBody body;
    floor(body);
    tested.build(body);
    Simulation simulation(body, "rk4");
    const VecX<double> start = simulation.state().q;
    double displacement = 0;
    const double h = 2e-3;
    for (int i = 0; i < 60; ++i) {
      simulation.step(h);
      displacement = std::max(displacement, (simulation.state().q - start).lpNorm<Eigen::Infinity>());
    }
    CHECK(displacement < tested.displacement);
    CHECK(simulation.state().v.norm() < 1e-11);
    double mass = 0;
    for (const auto& part : body.parts()) mass += part->total_mass();
    Vec3<double> impulse = Vec3<double>::Zero();
    const ContactRecord& record = simulation.contact()->record();
    for (std::size_t k = 0; k < record.contacts.size(); ++k)
      if (record.contacts[k].plane == 0) impulse += record.impulses[k];
    CHECK((impulse / h - Vec3<double>(0, 0, mass * kG)).norm() < 1e-9 * mass * kG);
  }
}

TEST_CASE("standing cylinders, flat tori and lying cylinders along their axis stop after v^2 / (2 mu g)",
          "[contact]") {
  for (const std::string tested : {"standing", "lying", "torus"})
    for (const double h : {4e-3, 2e-3}) {
      CAPTURE(tested, h);
      MultiBody body;
      body.contact.friction = 0.4;
      floor(body);
      Part& part = tested == "torus"
                       ? torus(body, "a", 0.05, 0.15)
                       : cylinder(body, "a", tested == "lying" ? 0.1 : 0.2, tested == "lying" ? 0.3 : 0.05);
      part.place({0, 0, tested == "lying" ? 0.1 : 0.05},
                 tested == "lying" ? lying_on_side() : Eigen::Quaterniond::Identity());
      part.velocity({1, tested == "lying" ? 0 : 0.3, 0}, {0, 0, 0});
      Simulation simulation(body, "rk4");
      const double v2 = simulation.state().v.head<3>().squaredNorm();
      test::run(simulation, 0.5, static_cast<int>(std::lround(0.5 / h)));
      CHECK(simulation.state().v.norm() < 1e-6);
      CHECK(std::abs(simulation.state().q.head<2>().norm() - v2 / (2 * 0.4 * kG)) < 0.4 * 0.4 * kG * h * h);
    }
}

TEST_CASE("cylinders, capsules and tori roll down a slope by the closed form", "[contact]") {
  // a = g sin(angle) / (1 + I / (m r^2)), with the distance r of the centre from the slope and the moment of
  // inertia I.
  const double angle = 0.3, tube = 0.05, ring = 0.15, r = 0.1, l = 0.3;
  const double side = l, caps = 4.0 / 3 * r;  // volumes of the cylinder and of both caps, divided by pi r^2
  struct Case {
    const char* name;
    double radius, inertia_ratio;  // m; I / (m r^2)
  };
  const std::vector<Case> cases{
      {"cylinder", r, 0.5},
      {"capsule", r, (side / 2 + caps * 2 / 5) / (side + caps)},
      {"torus", ring + tube, (ring * ring + 0.75 * tube * tube) / ((ring + tube) * (ring + tube))}};
  for (const Case& tested : cases) {
    CAPTURE(tested.name);
    MultiBody body;
    body.contact.friction = 0.6;
    const Eigen::Quaterniond tilt = rotation_about(angle, Vec3<double>::UnitY());
    const Vec3<double> n = tilt * Vec3<double>::UnitZ(), down = tilt * Vec3<double>::UnitX();
    body.plane("slope", Vec3<double>(0, 0, 0), n);
    Part& part = std::string(tested.name) == "torus"     ? torus(body, "a", tube, ring)
                 : std::string(tested.name) == "capsule" ? capsule(body, "a", r, l)
                                                         : cylinder(body, "a", r, 0.15);
    part.place(tested.radius * n, tilt * rotation_about(kPi / 2, Vec3<double>::UnitX()));
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.5, 200);
    const double a = kG * std::sin(angle) / (1 + tested.inertia_ratio);
    const Vec3<double> displacement = simulation.state().q.head<3>() - tested.radius * n;
    CHECK(simulation.state().v.head<3>().dot(down) == Approx(a / 2).epsilon(4e-9));
    CHECK(displacement.dot(down) == Approx(a / 8).epsilon(4e-9));
    CHECK(std::abs(displacement.dot(n)) < 1e-6);
  }
}

TEST_CASE("a cone, tip down, comes to rest in a torus", "[contact]") {
  const double half = std::atan(2.0 / 3), ring = 0.075, tube = 0.05;
  for (const double drop : {0.0, 0.02}) {
    MultiBody body;
    floor(body);
    torus(body, "a", tube, ring).place({0, 0, tube});
    // Height of the tip of the cone at which its surface has the distance `tube` from the core circle of the
    // torus.
    const double tip = tube - (ring * std::cos(half) - tube) / std::sin(half);
    cone(body, "b", 1).place({0, 0, tip + 0.15 + drop});
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.3, 75);
    CHECK((simulation.state().q.segment<3>(7) - Vec3<double>(0, 0, tip + 0.15)).norm() < 1e-12);
    CHECK(simulation.state().v.norm() < 1e-12);
  }
}

TEST_CASE("a part in contact along a line of its side rolls at most to the next sample point of its rim",
          "[contact][long]") {
  Draws draws(3);
  Worst rolled, raised;
  for (int trial = 0; trial < 6; ++trial)
    for (const std::string shape : {"cylinder", "cone", "capsule"}) {
      MultiBody body;
      floor(body);
      const double half = std::atan(2.0 / 3);
      Part& part = shape == "cylinder" ? cylinder(body, "a", 0.1, 0.15)
                   : shape == "cone"   ? cone(body, "a", -1)
                                       : capsule(body, "a", 0.1, 0.3);
      const Eigen::Quaterniond yaw = rotation_about(draws.uniform(-3, 3), Vec3<double>::UnitZ()),
                               roll = rotation_about(draws.uniform(-3, 3), Vec3<double>::UnitZ()),
                               side = shape == "cone"
                                          ? rotation_about(half, Vec3<double>::UnitY()) * lying_on_side()
                                          : lying_on_side();
      part.place({0, 0, shape == "cone" ? 0.15 * std::sin(half) : 0.1}, yaw * side * roll);
      Simulation simulation(body, "rk4");
      const VecX<double> start = simulation.state().q;
      for (int i = 0; i < 400; ++i) {
        simulation.step(5e-3);
        rolled.note((simulation.state().q - start).head<2>().norm());
        raised.note(std::abs(simulation.state().q[2] - start[2]));
      }

      CHECK(simulation.state().v.norm() < 1e-6);
    }
  CHECK(rolled < 4.5e-5);
  CHECK(raised < 1.5e-9);
}

TEST_CASE("parts with nearly flat faces rest on their lowest point", "[contact]") {
  for (const double eps1 : {0.03, 0.036, 0.04, 0.043, 0.046, 0.2}) {
    CAPTURE(eps1);
    MultiBody body;
    floor(body);
    test::add(body, "a", "superellipsoid", {}, 1000)
        .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}, {"eps1", eps1}, {"eps2", 0.1}})
        .place({0, 0, 0.11});
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.4, 200);
    CHECK(std::abs(simulation.state().q[2] - 0.1) < 1e-12);
    CHECK(simulation.state().v.norm() < 1e-10);
  }
}

TEST_CASE("dropped cylinders, cones, tori and deformed solids come to rest on their lowest points",
          "[contact][long]") {
  struct Kind {
    const char *name, *shape;
    std::vector<std::string> chain;
    Part::Named rest;
  };
  const std::vector<Kind> kinds{
      {"cylinder", "cylinder", {}, {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}}},
      {"cone", "cone", {}, {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}, {"t", -1}}},
      {"frustum", "cone", {}, {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.15}, {"t", -0.4}}},
      {"torus", "supertoroid", {}, {{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.05}, {"a4", 3}}},
      {"tapered box",
       "box",
       {"taper"},
       {{"a1", 0.1}, {"a2", 0.12}, {"a3", 0.15}, {"taper.tx", -0.4}, {"taper.ty", -0.2}}},
      {"bent capsule", "capsule", {"bend"}, {{"r", 0.05}, {"l", 0.4}, {"bend.angle", 0.8}}}};
  for (const Kind& kind : kinds)
    for (int trial = 0; trial < 2; ++trial) {
      CAPTURE(kind.name, trial);
      Draws draws(static_cast<std::uint64_t>(17 + trial));
      MultiBody body;
      floor(body);
      Part& part = test::add(body, "a", kind.shape, kind.chain, 1000);
      const Vec3<double> turn = draws.vector(1);
      part.rest(kind.rest).damping(0, 0, 3);
      part.place({0, 0, 0.5}, Eigen::Quaterniond(1, turn[0], turn[1], turn[2]).normalized());
      part.velocity(draws.vector(0.3), draws.vector(2));
      Simulation simulation(body, "rk4");
      const double start = simulation.ledger().energy();
      double deep = 0, before = start, gained = 0;
      for (int i = 0; i < 2500; ++i) {
        simulation.step(2e-3);
        if (i % 20 != 0) continue;
        for (const Contact& contact :
             ContactFinder(simulation.model()).find(simulation.state(), simulation.time(), 0))
          deep = std::max(deep, -contact.gap);
        const double energy = simulation.ledger().energy();
        gained = std::max(gained, energy - before);
        before = energy;
      }
      const Surface fine(part, 32);
      const Mat3<double> R = simulation.model().orientation(simulation.state(), 0).toRotationMatrix();
      const Eigen::Matrix3Xd x = R * part.s(fine.material(), part.parameters().rest());
      const double lowest = x.row(2).minCoeff() + simulation.state().q[2];
      CHECK(deep < 1e-6 * part.size());
      CHECK(std::abs(lowest) < 1e-4 * part.size());
      CHECK(gained <= 1e-8 * start);
      CHECK(simulation.state().v.norm() < 1e-4);
    }
}

TEST_CASE("a cylinder that starts deeper in a table than half its thickness is pushed out on the near side",
          "[contact]") {
  MultiBody body;
  body.contact.active = true;
  test::add(body, "table", "box", {}, 1000)
      .rest({{"a1", 1}, {"a2", 1}, {"a3", 0.01}})
      .place({0, 0, -0.01})
      .fix();
  test::add(body, "can", "cylinder", {}, 1000)
      .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
      .place({0.03, 0.02, 0.085});
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.8, 400);
  CHECK(std::abs(simulation.state().q[2] - 0.1) < 1e-6);
  CHECK(simulation.state().v.norm() < 1e-6);
}

}  // namespace round_solids_test
