// Assembly of joints before time 0: consistent initial states from distant, rotated and deformed parts. The
// last case closes a joint during the run.
// N36 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cstdio>

#include <Eigen/Geometry>

#include <pliant/body/joints/rod.h>
#include <pliant/body/joints/string.h>

#include "draws.h"
#include "motion.h"
#include "widest_gap.h"

namespace assembly_test {

using namespace pliant;
using test::Draws;
using test::widest_gap;

namespace {

/// Adds a random tree of ellipsoids on ball joints, whose first part is joined to the world. The parts start
/// in random poses, up to `apart` body lengths (1 m) from each other along each axis. joints: number of
/// joints and of parts.
void random_tree(MultiBody& body, int joints, double apart, std::uint64_t seed) {
  Draws draws(seed);
  body.stabilization.assemble_first = true;
  std::vector<Part*> parts;
  for (int i = 0; i < joints; ++i) {
    Part& part = test::add(body, "part" + std::to_string(i), "ellipsoid", {}, 1000);
    part.rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.5}});
    const Vec3<double> axis = draws.vector(1);
    part.place(apart * 0.5 * draws.vector(1),
               Eigen::Quaterniond(Eigen::AngleAxisd(draws.uniform(0, 3), axis.normalized())));
    auto anywhere = [&](const Part& on) {
      return point(on, draws.uniform(-1.5, 1.5), draws.uniform(-3, 3), draws.uniform(0.2, 1));
    };
    const Point to = parts.empty() ? world(0, 0, 0)
                                   : anywhere(*parts[static_cast<std::size_t>(
                                         draws.uniform(0, static_cast<double>(parts.size()) - 1e-9))]);
    body.ball("joint" + std::to_string(i), to, anywhere(part));
    parts.push_back(&part);
  }
}

}  // namespace

TEST_CASE("N36: assembly before time 0 closes trees of 1 to 100 joints from 3 to 1000 body lengths",
          "[joints]") {
  for (const double apart : {3, 10, 100, 1000})
    for (const int joints : {1, 4, 12, 100}) {
      MultiBody body;
      random_tree(body, joints, apart, static_cast<std::uint64_t>(joints + apart));
      const Simulation simulation(body, "rk4");
      INFO(joints << " joints, " << apart << " lengths apart: " << simulation.assembly().iterations
                  << " iterations");
      CHECK(widest_gap(simulation) <= 1e-10);
      CHECK(simulation.assembly().iterations <= 100);
      CHECK(simulation.assembly().gap_before >= 0.3);
      for (const JointMode mode : simulation.state().joints) CHECK(mode == JointMode::closed);
    }
}

TEST_CASE("N36: assembly closes all joints of a thousand random layouts", "[joints]") {
  int max_iterations = 0;
  double sum = 0;
  for (int layout = 0; layout < 1000; ++layout) {
    MultiBody body;
    const double apart = layout % 3 == 0 ? 3 : (layout % 3 == 1 ? 10 : 100);
    random_tree(body, 1 + layout % 12, apart, 1000 + static_cast<std::uint64_t>(layout));
    const Simulation simulation(body, "rk4");
    REQUIRE(widest_gap(simulation) <= 1e-10);
    max_iterations = std::max(max_iterations, simulation.assembly().iterations);
    sum += simulation.assembly().iterations;
  }
  INFO("mean iterations " << sum / 1000);
  CHECK(max_iterations <= 100);
}

TEST_CASE("assembly closes loops, hinges and welds, and shortens strings that are too long", "[joints]") {
  MultiBody body;
  body.stabilization.assemble_first = true;
  Draws draws(5);
  std::vector<Part*> ring;
  for (int i = 0; i < 6; ++i) {
    Part& part = test::add(body, "part" + std::to_string(i), "ellipsoid", {}, 1000);
    part.rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.5}});
    part.place(3 * draws.vector(1), Eigen::Quaterniond(Eigen::AngleAxisd(2, draws.vector(1).normalized())));
    ring.push_back(&part);
  }
  for (std::size_t i = 0; i < 6; ++i)
    body.ball("ring" + std::to_string(i), point(*ring[i], kPi / 2, 0),
              point(*ring[(i + 1) % 6], -kPi / 2, 0));
  Part& wheel = test::add(body, "wheel", "cylinder", {}, 1000);
  wheel.place({4, -3, 2}, Eigen::Quaterniond(0.1, 0.9, 0.3, -0.2).normalized());
  Part& box = test::add(body, "box", "box", {}, 1000);
  box.place({-2, 7, 0}, Eigen::Quaterniond(0, 1, 0, 0));
  JointSetting hinge{point(wheel, 0.2, 0.3), point(*ring[0], 0, 0)};
  hinge.from_axis = Vec3<double>(0, 0, 1);
  hinge.axis = {1, 0, 0};
  body.join("hinge", "hinge", hinge);
  JointSetting weld{point(box, 0.2, 0.3), point(*ring[2], 0, 1)};
  weld.rotation = Eigen::Quaterniond::Identity();
  body.join("weld", "weld", weld);
  body.join("string", String{0.5}, {point(wheel, -0.5, 0), point(box, 0, 2)});
  const Simulation simulation(body, "rk4");
  CHECK(widest_gap(simulation) <= 1e-10);
  CHECK(simulation.assembly().iterations <= 200);
  CHECK(simulation.assembly().converged);
}

TEST_CASE("assembly changes parameters in proportion to their compliance", "[joints]") {
  // The anchors are farther apart than the two parts are long. Both must stretch, the soft part more.
  MultiBody body;
  body.stabilization.assemble_first = true;
  for (const char* name : {"soft", "stiff"}) {
    Part& part = test::add(body, name, "ellipsoid", {}, 1000);
    part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.5}});
    part.stiffness({{"a3", name == std::string("soft") ? 1e3 : 3e3}, {"a1", 2e3}});
    part.place({0.3, name == std::string("soft") ? 2. : -5., 0.4},
               Eigen::Quaterniond(0.4, 0.5, 0.6, 0.2).normalized());
    part.initial({{"a1", 0.13}});
  }
  Part &soft = *body.find("soft"), &stiff = *body.find("stiff");
  body.ball("top", world(0, 0, 1.5), point(soft, kPi / 2, 0));
  body.ball("middle", point(soft, -kPi / 2, 0), point(stiff, kPi / 2, 0));
  body.ball("bottom", world(0, 0, -1.3), point(stiff, -kPi / 2, 0));
  const Simulation simulation(body, "rk4");
  CHECK(widest_gap(simulation) <= 1e-12);
  const Model& model = simulation.model();
  const double longer_soft = simulation.state().q[model.parts()[0].q0 + 8] - 0.5,
               longer_stiff = simulation.state().q[model.parts()[1].q0 + 8] - 0.5;
  CHECK(2 * (longer_soft + longer_stiff) == Approx(0.8).epsilon(1e-9));
  CHECK(longer_soft == Approx(3 * longer_stiff).epsilon(1e-5));
  // A parameter that no joint constrains goes to its rest value.
  CHECK(simulation.state().q[model.parts()[0].q0 + 7] == Approx(0.1).epsilon(1e-6));

  SECTION("parameters do not change where rigid motion suffices") {
    MultiBody loose;
    loose.stabilization.assemble_first = true;
    Part& a = test::add(loose, "a", "ellipsoid", {"bend"}, 1000);
    a.stiffness({{"a3", 1e3}, {"bend.angle", 10}})
        .place({5, 5, 5}, Eigen::Quaterniond(0.4, 0.5, 0.6, 0.2).normalized());
    loose.ball("pin", point(a, 1, 1), world(0, 0, 0));
    const Simulation pinned(loose, "rk4");
    CHECK(widest_gap(pinned) <= 1e-12);
    CHECK(std::abs(pinned.state().q[7] - a.parameters().moving(0).rest_value()) <= 1e-7);
    CHECK(std::abs(pinned.state().q[8]) <= 1e-7);
  }
}

TEST_CASE(
    "scattered beads are joined between posts that are too far apart for unstretched beads: all stretch "
    "equally",
    "[joints]") {
  // Once the chain is straight, rotations of its beads change the gaps to second order only: the beads must
  // stretch.
  MultiBody body;
  body.stabilization.assemble_first = true;
  Draws draws(7);
  constexpr int n = 5;
  for (int i = 0; i < n; ++i) {
    Part& bead = test::add(body, "bead" + std::to_string(i), "ellipsoid", {}, 400);
    bead.rest({{"a1", 0.12}, {"a2", 0.12}, {"a3", 0.25}}).stiffness({{"a1", 2e4}, {"a2", 2e4}, {"a3", 8e3}});
    bead.place(
        {draws.uniform(-2, 2), draws.uniform(-2, 2), draws.uniform(-2, 2)},
        Eigen::Quaterniond(draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1), 1).normalized());
    body.ball("ball" + std::to_string(i),
              i == 0 ? world(-1.6, 0, 0) : point(*body.parts()[static_cast<std::size_t>(i) - 1], kPi / 2, 0),
              point(bead, -kPi / 2, 0));
  }
  body.ball("end", point(*body.parts().back(), kPi / 2, 0), world(1.6, 0, 0));
  const Simulation simulation(body, "rk4");
  CHECK(widest_gap(simulation) <= 1e-12);
  for (const PartModel& m : simulation.model().parts())
    CHECK(simulation.state().q[m.q0 + 9] == Approx(0.32).epsilon(1e-3));
}

TEST_CASE("assembly releases limits that become inactive, and ends when the shape has converged",
          "[joints]") {
  MultiBody body;
  body.stabilization.assemble_first = true;
  for (const char* name : {"left", "right"}) {
    Part& part = test::add(body, name, "ellipsoid", {}, 1000);
    part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.5}}).stiffness({{"a3", 1e4}}).limits("a3", {0.5, 2});
    part.place({name == std::string("left") ? -0.5 : 0.5, 0, 0.01},
               Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitY())));
  }
  Part &left = *body.find("left"), &right = *body.find("right");
  body.ball("l", world(-1.2, 0, 0), point(left, -kPi / 2, 0));
  body.ball("m", point(left, kPi / 2, 0), point(right, -kPi / 2, 0));
  body.ball("r", world(1.2, 0, 0), point(right, kPi / 2, 0));
  const Simulation simulation(body, "rk4");
  CHECK(simulation.state().q[7] == Approx(0.6).epsilon(1e-6));
  CHECK(simulation.state().q[15] == Approx(0.6).epsilon(1e-6));
  CHECK(simulation.state().at_limit[0] == 0);
  CHECK(simulation.assembly().iterations <= 100);
  CHECK(widest_gap(simulation) <= 1e-10);
}

TEST_CASE("assembly does not change an assembled model, and starts other models from their initial poses",
          "[joints]") {
  MultiBody body, reference_body;
  for (MultiBody* b : {&body, &reference_body}) {
    Part& a = test::add(*b, "a", "ellipsoid", {"bend"}, 1000);
    a.stiffness({{"a3", 1e3}, {"bend.angle", 10}}).initial({{"bend.angle", 0.3}});
    Part& c = test::add(*b, "c", "ellipsoid", {}, 1000);
    a.prepare();
    ParameterValues<double> values = a.parameters().rest();
    values.b[static_cast<std::size_t>(a.parameters().find("bend.angle"))] = 0.3;
    c.place(Vec3<double>(a.s({material_at(0.3, 1)}, values).col(0)));
    b->ball("joint", point(a, 0.3, 1), point(c, 0, 0, 0));
  }
  body.stabilization.assemble_first = true;
  const Simulation assembled(body, "rk4"), plain(reference_body, "rk4");
  CHECK(assembled.assembly().iterations == 0);
  CHECK(hash(assembled.state()) == hash(plain.state()));
}

TEST_CASE("a joint that cannot close is named with its gap", "[joints]") {
  MultiBody body;
  body.stabilization.assemble_first = true;
  Part& part = test::add(body, "part", "sphere", {}, 1000);
  part.rest({{"r", 0.2}});
  body.ball("left", point(part, 0, 0), world(0, 0, 0));
  body.ball("right", point(part, 0, kPi), world(1, 0, 0));
  try {
    const Simulation simulation(body, "rk4");
    FAIL("a ball of 0.4 m cannot span 1 m");
  } catch (const UnsatisfiableModel& failure) {
    const std::string what = failure.what();
    INFO(what);
    CHECK((what.find("'left'") != std::string::npos || what.find("'right'") != std::string::npos));
    CHECK(what.find("cannot close") != std::string::npos);
    CHECK(what.find(" m") != std::string::npos);
  }
}

TEST_CASE("a part that spins freely keeps its spin while a joint of its island closes",
          "[assembly][joints]") {
  // An island is a set of parts that joints connect. The joint of part a is released at 0.005 s; the other
  // joint of the island closes from 0.1 s on.
  for (const char* method : {"semi_implicit_euler", "rk4"}) {
    CAPTURE(method);
    MultiBody body;
    body.gravity.setZero();
    Part& a = body.add(make_part("a", "sphere", {}, 1000));
    Part& b = body.add(make_part("b", "sphere", {}, 1000));
    a.rest({{"r", 0.1}}).velocity({0, 0, 0}, {0, 0, 30});
    b.rest({{"r", 0.1}}).place({0.2, 0, 0});
    body.ball("between", point(a, 0, 0, 0), point(b, 0, kPi, 1)).during(0, 0.005);
    body.ball("late", point(b, 0, 0, 1), world(0.4, 0, 0)).during(0.1);
    Simulation simulation(body, method);
    const double L = simulation.ledger().angular_momentum[2];
    test::run(simulation, 1, 100);  // 0.3 rad a step
    CHECK(simulation.state().v[5] == Approx(30).epsilon(1e-9));
    CHECK(std::abs(simulation.ledger().work[static_cast<int>(Work::baumgarte)]) <
          0.1);  // J; the kinetic energy is 7.5 J
    CHECK(simulation.ledger().angular_momentum[2] > 0.99 * L);
  }
}

}  // namespace assembly_test
