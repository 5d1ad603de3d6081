// Closed loops and long chains of joints: energy, gaps and ranks of mechanisms with redundant rows, passages
// through singular positions, extreme mass ratios.
// N39, N40, N43 and N44 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <functional>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/body/constraint/constraints.h>
#include <pliant/body/joints/rod.h>
#include <pliant/body/model.h>

#include "motion.h"
#include "widest_gap.h"

namespace loops_test {

using namespace pliant;
using test::widest_gap;

namespace {

const Vec3<double> kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// Adds a uniform square rod from one position to another (m, world). Its z axis is along the rod, and its y
/// axis is `side`, a unit vector perpendicular to the rod. half_width: m; mass: kg.
Part& rod(MultiBody& body, const std::string& name, const Vec3<double>& from, const Vec3<double>& to,
          const Vec3<double>& side, double half_width, double mass = 1) {
  const Vec3<double> along = (to - from).normalized();
  Mat3<double> R;
  R << side.cross(along), side, along;
  Part& part = test::add(body, name, "box", {}, 1000);
  part.rest({{"a1", half_width}, {"a2", half_width}, {"a3", (to - from).norm() / 2}}).mass(mass);
  part.place((from + to) / 2, Eigen::Quaterniond(R));
  return part;
}
Point start_of(const Part& rod) {
  return point(rod, -kPi / 2, 0);
}
Point end_of(const Part& rod) {
  return point(rod, kPi / 2, 0);
}

/// Adds a hinge whose pin has the given direction in the world.
void hinge(MultiBody& body, const Point& a, const Point& b, const Vec3<double>& pin) {
  const Vec3<double> axis = b.part == nullptr ? pin : Vec3<double>(b.part->R0().conjugate() * pin);
  body.hinge("hinge" + std::to_string(body.joints().size()), a, b, axis);
}
Point world_at(const Vec3<double>& x) {
  return world(x[0], x[1], x[2]);
}

/// Adds a planar four-bar linkage in the plane y = 0: a crank of 0.35 m that can make full turns, a coupler
/// and a rocker. mass_ratio: mass of the coupler, kg; the other bars have 1 kg.
void four_bar(MultiBody& body, double mass_ratio = 1) {
  const Vec3<double> O(0, 0, 0), C(1, 0, 0), A = 0.35 * Vec3<double>(std::cos(1.2), 0, std::sin(1.2));
  // B is 0.9 m from A and 0.8 m from C.
  const double d = (C - A).norm(), along = (0.81 - 0.64 + d * d) / (2 * d);
  const Vec3<double> u = (C - A) / d;
  const Vec3<double> B = A + along * u + std::sqrt(0.81 - along * along) * u.cross(kY);
  Part& crank = rod(body, "crank", O, A, kY, 0.02);
  Part& coupler = rod(body, "coupler", A, B, kY, 0.02, mass_ratio);
  Part& rocker = rod(body, "rocker", B, C, kY, 0.02);
  hinge(body, start_of(crank), world_at(O), kY);
  hinge(body, start_of(coupler), end_of(crank), kY);
  hinge(body, start_of(rocker), end_of(coupler), kY);
  hinge(body, end_of(rocker), world_at(C), kY);
}

/// Adds problem A02 of the IFToMM library of multibody benchmarks: windows + 1 upright rods on the ground, 1
/// m apart, with bars between their upper ends. The uprights rotate at 1 rad/s, and the bars translate.
void windows_in_a_row(MultiBody& body, int windows) {
  std::vector<Part*> upright;
  for (int i = 0; i <= windows; ++i) {
    const Vec3<double> foot = i * kX;
    upright.push_back(&rod(body, "upright" + std::to_string(i), foot, foot + kZ, kY, 0.005));
    upright.back()->velocity(0.5 * kX, kY);
    hinge(body, start_of(*upright.back()), world_at(foot), kY);
  }
  for (int i = 0; i < windows; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Part& bar = rod(body, "bar" + std::to_string(i), i * kX + kZ, (i + 1) * kX + kZ, kY, 0.005);
    bar.velocity(kX, {0, 0, 0});
    hinge(body, start_of(bar), end_of(*upright[k]), kY);
    hinge(body, end_of(bar), end_of(*upright[k + 1]), kY);
  }
}

/// Adds IFToMM A04, Bricard's mechanism: six edges of a cube form a hexagon; the first edge is the ground.
/// mass_ratio: mass of every second link, kg; the other links have 1 kg.
void bricard(MultiBody& body, double mass_ratio = 1) {
  const std::array<Vec3<double>, 6> corners{kX, kX + kY, kY, kY + kZ, kZ, kZ + kX};
  // Each pin is perpendicular to both edges of its corner.
  const std::array<Vec3<double>, 6> pins{kX, kZ, kY, kX, kZ, kY};
  const Part* before = nullptr;
  for (std::size_t i = 1; i < 6; ++i) {
    const Vec3<double>&from = corners[i], &to = corners[(i + 1) % 6];
    Part& link = rod(body, "link" + std::to_string(i), from, to, pins[i], 0.05, i % 2 == 0 ? mass_ratio : 1);
    hinge(body, start_of(link), before == nullptr ? world_at(from) : end_of(*before), pins[i]);
    before = &link;
  }
  hinge(body, end_of(*before), world_at(corners[0]), pins[0]);
}

/// Adds rods on ball joints in a ring of radius 1 m about the origin. The ring rotates about its axis and
/// oscillates. mass_ratio: mass of every second rod, kg; the other rods have 1 kg.
void ring(MultiBody& body, int links, double mass_ratio = 1) {
  auto at = [&](double i) {
    const double angle = 2 * kPi * i / links;
    return Vec3<double>(std::cos(angle), std::sin(angle), 0);
  };
  for (int i = 0; i < links; ++i) {
    Part& link =
        rod(body, "link" + std::to_string(i), at(i), at(i + 1), kZ, 0.3 / links, i % 2 == 0 ? mass_ratio : 1);
    const Vec3<double> c = (at(i) + at(i + 1)) / 2, spin(0, 0, 1);
    const Vec3<double> heave = 0.3 * std::cos(3 * 2 * kPi * (i + 0.5) / links) * kZ + 0.2 * c[1] * kX;
    link.velocity(spin.cross(c) + heave, link.R0().conjugate() * spin);
  }
  for (int i = 0; i < links; ++i) {
    const Part &a = *body.find("link" + std::to_string(i)),
               &b = *body.find("link" + std::to_string((i + 1) % links));
    body.ball("joint" + std::to_string(i), end_of(a), start_of(b));
  }
}

/// Return functions from the number of a link to its mass (kg). heavy_end: `mass` for the last link, 1 kg for
/// all others. alternating: two masses in turn.
std::function<double(int)> heavy_end(int links, double mass) {
  return [=](int i) { return i + 1 == links ? mass : 1; };
}
std::function<double(int)> alternating(double first, double second) {
  return [=](int i) { return i % 2 == 0 ? first : second; };
}

/// Adds rods of 1 m on ball joints from the origin down. The inclination increases along the chain to `lean`
/// (rad) at the last rod. mass(i): mass of rod i, kg.
void chain(MultiBody& body, int links, double lean, const std::function<double(int)>& mass) {
  Vec3<double> from(0, 0, 0);
  const Part* before = nullptr;
  for (int i = 0; i < links; ++i) {
    const double angle = lean * (i + 1) / links;
    const Vec3<double> to = from + Vec3<double>(std::sin(angle), 0, -std::cos(angle));
    Part& link = rod(body, "link" + std::to_string(i), from, to, kY, 0.1, mass(i));
    body.ball("joint" + std::to_string(i), start_of(link),
              before == nullptr ? world(0, 0, 0) : end_of(*before));
    from = to;
    before = &link;
  }
}

/// Adds a copy of each ball joint.
void double_the_balls(MultiBody& body) {
  const std::size_t n = body.joints().size();
  for (std::size_t j = 0; j < n; ++j) {
    const std::vector<Point> points = body.joints()[j]->points();
    body.ball("copy" + std::to_string(j), points[0], points[1]);
  }
}

/// Returns the number of redundant rows (scalar constraint equations) of all joints.
int redundant(const Simulation& simulation) {
  Workspace<double> work;
  const State& s = simulation.state();
  simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
  const std::vector<int> rows = redundant_rows(simulation.model(), work.joints);
  return std::accumulate(rows.begin(), rows.end(), 0);
}

/// Returns the largest absolute value of the multipliers lambda of all joints. Requires that they are finite.
double max_lambda(const Simulation& simulation) {
  Workspace<double> work;
  const State& s = simulation.state();
  simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
  REQUIRE(work.joints.lambda.allFinite());
  return work.joints.lambda.lpNorm<Eigen::Infinity>();
}

struct MaxErrors {
  double energy = 0, gap = 0;  // J, m
};

/// Runs a conservative motion and returns the largest errors of all steps.
MaxErrors max_errors(Simulation& simulation, double end, int steps) {
  const double energy = simulation.ledger().energy();
  MaxErrors worst;
  for (int i = 0; i < steps; ++i) {
    simulation.step(end / steps);
    worst.gap = std::max(worst.gap, widest_gap(simulation));
    worst.energy = std::max(worst.energy, std::abs(simulation.ledger().energy() - energy));
  }
  return worst;
}

}  // namespace

TEST_CASE("IFToMM A01: a point pendulum released horizontally keeps its period and its energy", "[loops]") {
  // The period is 4 sqrt(l / g) K(sin^2(45 degrees)), with the complete elliptic integral K(m).
  const double period = 2.367841947576;
  MultiBody body;
  Part& mass = test::add(body, "mass", "sphere", {}, 1000);
  mass.rest({{"r", 0.05}}).mass(1).place(kX);
  body.join("rod", Rod{1}, {world(0, 0, 0), point(mass, 0, 0, 0)});
  Simulation simulation(body, "rk4");
  const double end = 4.25 * period;  // 10.06 s, at the bottom for the ninth time
  const MaxErrors worst = max_errors(simulation, end, 8000);
  CHECK(worst.energy <= 1e-6 * 9.81);
  CHECK(worst.gap <= 1e-12);
  const Vec3<double> c = simulation.state().q.head<3>();
  CHECK(std::abs(c[0]) <= 1e-6);
  CHECK(c[2] == Approx(-1).epsilon(1e-10));
  CHECK(std::abs(simulation.state().v[0]) == Approx(std::sqrt(2 * 9.81)).epsilon(1e-7));
}

TEST_CASE("N43: ranks of closed loops", "[loops]") {
  SECTION(
      "four hinges of a planar four-bar linkage: 20 rows of rank 17, so that 1 of 18 velocities is free") {
    MultiBody body;
    four_bar(body);
    const Simulation simulation(body, "rk4");
    CHECK(simulation.model().n_v() == 18);
    CHECK(redundant(simulation) == 3);
  }
  SECTION("Bricard's mechanism: 30 rows of rank 29, so that 1 of 30 velocities is free") {
    MultiBody body;
    bricard(body);
    const Simulation simulation(body, "rk4");
    CHECK(simulation.model().n_v() == 30);
    CHECK(redundant(simulation) == 1);
  }
  SECTION("a ring on ball joints has no redundant row") {
    MultiBody body;
    ring(body, 100);
    CHECK(redundant(Simulation(body, "rk4")) == 0);
  }
}

TEST_CASE("N43: a planar four-bar linkage for 10 s: energy and gaps", "[loops]") {
  MultiBody body;
  four_bar(body);
  Simulation simulation(body, "rk4");
  const MaxErrors worst = max_errors(simulation, 10, 5000);
  INFO(worst.energy << " J, " << worst.gap << " m");
  CHECK(worst.energy <= 1e-6 * 3 * 9.81);  // 1e-6 m g l, with m = 3 kg and l = 1 m
  CHECK(worst.gap <= 1e-9);
}

TEST_CASE("IFToMM A02: two windows of bars turn through the positions where all bars are collinear",
          "[loops][long]") {
  MultiBody body;
  windows_in_a_row(body, 2);
  Simulation simulation(body, "rk4");
  // The velocities are consistent with the joints.
  CHECK(simulation.ledger().kinetic == Approx(1.5).epsilon(1e-4));
  const double energy = simulation.ledger().energy();
  MaxErrors worst;
  int turns = 0;
  double before = 0.5;
  for (int i = 0; i < 5000; ++i) {
    simulation.step(2e-3);
    worst.gap = std::max(worst.gap, widest_gap(simulation));
    worst.energy = std::max(worst.energy, std::abs(simulation.ledger().energy() - energy));
    const double height = simulation.state().q[2];
    turns += before < 0 && height >= 0 ? 1 : 0;
    before = height;
  }
  INFO(worst.energy << " J, " << worst.gap << " m");
  CHECK(turns >= 4);
  CHECK(worst.energy <= 1e-6 * 5 * 9.81);
  CHECK(worst.gap <= 1e-9);
}

TEST_CASE("IFToMM A02: 35 rows of rank 29 wherever the bars are not collinear", "[loops]") {
  MultiBody body;
  windows_in_a_row(body, 2);
  Simulation simulation(body, "rk4");
  CHECK(redundant(simulation) == 6);
  for (int i = 0; i < 20; ++i) {
    simulation.step(0.01);
    CHECK(redundant(simulation) == 6);
  }
}

TEST_CASE("IFToMM A04: Bricard's mechanism from rest, for 10 s", "[loops][long]") {
  MultiBody body;
  bricard(body);
  Simulation simulation(body, "rk4");
  const MaxErrors worst = max_errors(simulation, 10, 10000);
  INFO(worst.energy << " J, " << worst.gap << " m");
  CHECK(worst.energy <= 1e-6 * 5 * 9.81);
  CHECK(worst.gap <= 1e-9);
}

TEST_CASE("N43: mechanisms with redundant rows, by the augmented matrix", "[loops][long]") {
  const std::pair<const char*, std::function<void(MultiBody&)>> mechanisms[] = {
      {"Bricard", [](MultiBody& body) { bricard(body); }},
      {"windows", [](MultiBody& body) { windows_in_a_row(body, 2); }},
      {"four bars", [](MultiBody& body) { four_bar(body); }}};
  for (const auto& [name, build] : mechanisms) {
    MultiBody body;
    build(body);
    body.joint_solver.choice = JointSolver::Choice::augmented;
    Simulation simulation(body, "rk4");
    REQUIRE(simulation.model().islands()[0].augmented);
    const MaxErrors worst = max_errors(simulation, 4, 4000);
    INFO(name << ": " << worst.energy << " J, " << worst.gap << " m");
    CHECK(worst.energy <= 1e-6 * 5 * 9.81);
    CHECK(worst.gap <= 1e-9);
  }
}

TEST_CASE("N43: a ring of 100 links in free flight for 10 s: energy and gaps", "[loops]") {
  MultiBody body;
  body.gravity.setZero();
  ring(body, 100);
  Simulation simulation(body, "rk4");
  const Ledger before = simulation.ledger();
  const MaxErrors worst = max_errors(simulation, 10, 2000);
  const Ledger after = simulation.ledger();
  INFO(worst.energy << " J, " << worst.gap << " m");
  CHECK(worst.energy <= 1e-6 * before.kinetic);
  CHECK(worst.gap <= 1e-9);
  CHECK((after.momentum - before.momentum).norm() <= 1e-9 * before.angular_momentum.norm());
  CHECK((after.angular_momentum - before.angular_momentum).norm() <= 1e-6 * before.angular_momentum.norm());
}

namespace {

/// Adds a crank and an arm of equal length; the end of the arm slides on the x axis. angle: initial angle of
/// the crank from upright, rad. When crank and arm coincide, the end of the arm is at the pivot of the crank.
/// Then the mechanism can move in two ways: crank and arm together, or apart.
void equal_crank(MultiBody& body, double angle) {
  const Vec3<double> A(std::sin(angle), 0, std::cos(angle)), B(2 * std::sin(angle), 0, 0);
  Part& crank = rod(body, "crank", {0, 0, 0}, A, kY, 0.02);
  Part& arm = rod(body, "arm", A, B, kY, 0.02);
  hinge(body, start_of(crank), world(0, 0, 0), kY);
  hinge(body, start_of(arm), end_of(crank), kY);
  body.join("line", "line", {end_of(arm), world(0, 0, 0), 0, kX, {}, {}});
}

/// Adds an arm of two rods of 1 m from the origin to a moving anchor on the x axis. reach: initial distance
/// of the anchor, m. anchor_x: its coordinate x, m.
void arm(MultiBody& body, double reach, const TimeFunction& anchor_x) {
  const Vec3<double> elbow(reach / 2, 0, -std::sqrt(1 - reach * reach / 4));
  Part& upper = rod(body, "upper", {0, 0, 0}, elbow, kY, 0.02);
  Part& lower = rod(body, "lower", elbow, reach * kX, kY, 0.02);
  body.ball("shoulder", start_of(upper), world(0, 0, 0));
  body.ball("elbow", end_of(upper), start_of(lower));
  body.ball("hand", end_of(lower), world({anchor_x, 0, 0}));
}

}  // namespace

TEST_CASE("N44: a crank and an arm of equal length pass the position in which they coincide", "[loops]") {
  MultiBody body;
  equal_crank(body, 0.5);
  Simulation simulation(body, "rk4");
  CHECK(redundant(simulation) == 1);
  const double energy = simulation.ledger().energy();
  bool passed = false;
  for (int i = 0; i < 2000; ++i) {
    const double before = simulation.state().q[7];
    simulation.step(1e-3);
    passed = passed || before * simulation.state().q[7] < 0;
    REQUIRE(widest_gap(simulation) <= 1e-10);
    REQUIRE(max_lambda(simulation) <= 1e4);
    REQUIRE(std::abs(simulation.ledger().energy() - energy) <= 1e-6 * 2 * 9.81);
  }
  CHECK(passed);
}

TEST_CASE("N44: in the singular position the rank falls by one, and either motion can start", "[loops]") {
  for (const bool together : {true, false}) {
    MultiBody body;
    equal_crank(body, 0);
    const double spin = 2;
    body.find("crank")->velocity({spin / 2, 0, 0}, {0, spin, 0});
    if (together)
      body.find("arm")->velocity({spin / 2, 0, 0}, {0, spin, 0});
    else
      body.find("arm")->velocity({spin * 3 / 2, 0, 0}, {0, -spin, 0});
    Simulation simulation(body, "rk4");
    INFO((together ? "together" : "apart"));
    CHECK(redundant(simulation) == 2);
    CHECK(max_lambda(simulation) <= 1e4);
    const double energy = simulation.ledger().energy();
    for (int i = 0; i < 500; ++i) {
      simulation.step(1e-3);
      REQUIRE(widest_gap(simulation) <= 1e-10);
      REQUIRE(std::abs(simulation.ledger().energy() - energy) <= 1e-6 * 2 * 9.81);
    }
    const double x = simulation.state().q[0], arm = simulation.state().q[7];  // centres
    CHECK(arm == Approx(together ? x : 3 * x).epsilon(1e-9));
  }
}

TEST_CASE(
    "N44: a straight arm between two walls: finite forces, and the run stops with the names of its joints",
    "[loops]") {
  // The weight pulls in the one direction in which the arm can exert no force.
  MultiBody body;
  arm(body, 2, 2);
  Simulation simulation(body, "rk4");
  CHECK(redundant(simulation) == 1);
  CHECK(max_lambda(simulation) <= 100);
  State good = simulation.state();
  try {
    for (int i = 0; i < 100; ++i) {
      simulation.step(1e-3);
      REQUIRE(widest_gap(simulation) <= 1e-10);
      good = simulation.state();
    }
    FAIL("the run did not stop");
  } catch (const UnsatisfiableModel& failure) {
    const std::string what = failure.what();
    CHECK(what.find("'elbow'") != std::string::npos);
    CHECK(what.find("'hand'") != std::string::npos);
    CHECK(simulation.state().q == good.q);
  }
}

TEST_CASE("N44: an anchor that moves beyond the reach of an arm stops the run when the arm is straight",
          "[loops]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    arm(body, 1.2, TimeFunction::formula("1.2 + t"));
    Simulation simulation(body, method);
    INFO(method);
    try {
      for (int i = 0; i < 1000; ++i) {
        simulation.step(1e-3);
        REQUIRE(widest_gap(simulation) <= 1e-10);
        REQUIRE(max_lambda(simulation) <= 1e9);
      }
      FAIL("the run did not stop");
    } catch (const UnsatisfiableModel& failure) {
      const std::string what = failure.what();
      CHECK(what.find("'shoulder'") != std::string::npos);
      CHECK(what.find("'hand'") != std::string::npos);
      CHECK(simulation.time() == Approx(0.8).margin(2e-3));
    }
  }
}

namespace {

/// Checks that no gap exceeds 1e-10 body lengths during a run, for every method. For more than 100 parts,
/// implicit_midpoint and esdirk are left out. length: length of a body, m. h: step, s.
void check_gaps(const std::string& name, const std::function<void(MultiBody&)>& make, double length, double h,
                int steps) {
  for (const IntegratorInfo& info : all_integrators()) {
    const std::string method = info.name;
    MultiBody body;
    make(body);
    if (body.parts().size() > 100 && (method == "implicit_midpoint" || method == "esdirk")) continue;
    Simulation simulation(body, method);
    double widest = 0;
    for (int i = 0; i < steps; ++i) {
      simulation.step(h);
      widest = std::max(widest, widest_gap(simulation));
    }
    INFO(name << " of " << body.parts().size() << " by " << method << ": " << widest / length);
    CHECK(widest <= 1e-10 * length);
  }
}

}  // namespace

TEST_CASE("joints stay closed for all mass ratios, in chains, loops and with doubled joints",
          "[loops][long]") {
  for (const double ratio : {1e-6, 1e6}) {
    INFO("ratio " << ratio);
    check_gaps(
        "four-bar linkage", [&](MultiBody& body) { four_bar(body, ratio); }, 0.35, 1e-3, 500);
    check_gaps(
        "ring", [&](MultiBody& body) { ring(body, 100, ratio); }, 2 * kPi / 100, 1e-3, 50);
    for (const int n : {10, 100}) {
      // A heavy end on light links causes waves of high frequency.
      const double h = ratio > 1 ? 1e-4 : 2e-3;
      check_gaps(
          "heavy end", [&](MultiBody& body) { chain(body, n, 0.5, heavy_end(n, ratio)); }, 1, h, 3000 / n);
      auto doubled = [&](MultiBody& body) {
        chain(body, n, 0.5, alternating(ratio, 1));
        double_the_balls(body);
      };
      check_gaps("alternating, doubled", doubled, 1, 2e-3, 3000 / n);
    }
  }
}

TEST_CASE("Bricard's mechanism stays closed for all mass ratios", "[loops]") {
  for (const double ratio : {1e-6, 1e6})
    check_gaps(
        "Bricard", [&](MultiBody& body) { bricard(body, ratio); }, 1, 1e-3, 300);
}

TEST_CASE("a thousand links stay joined, with an end mass of 1 kg and of 1e6 kg", "[loops][long]") {
  for (const double mass : {1., 1e6})
    check_gaps(
        "heavy end", [&](MultiBody& body) { chain(body, 1000, 0.5, heavy_end(1000, mass)); }, 1,
        mass > 1 ? 1e-4 : 2e-3, 200);
}

TEST_CASE("N39: a step of 1000 links takes at most 12 times as long as a step of 100 links",
          "[loops][long]") {
  // The median of the ratios of processor times of several rounds. The speed of the machine may change from
  // round to round.
  for (const char* method : {"rk4", "semi_implicit_euler"})
    for (const double mass : {1., 1e6}) {
      auto hanging = [&](MultiBody& body, int links) -> MultiBody& {
        chain(body, links, 0, heavy_end(links, mass));
        return body;
      };
      MultiBody short_one, long_one;
      Simulation small(hanging(short_one, 100), method), large(hanging(long_one, 1000), method);
      auto time = [](Simulation& simulation, int steps) {
        const std::clock_t start = std::clock();
        for (int i = 0; i < steps; ++i) simulation.step(1e-4);
        return static_cast<double>(std::clock() - start) / steps;
      };
      std::vector<double> ratios;
      for (int round = 0; round < 31; ++round) ratios.push_back(time(large, 10) / time(small, 100));
      const auto median = ratios.begin() + 15;
      std::nth_element(ratios.begin(), median, ratios.end());
      INFO(method << ", " << mass << " kg: ratio " << *median);
      CHECK(*median <= 12);
    }
}

TEST_CASE("N40: 1000 links that alternate between 1 kg and 1e6 kg swing for a minute without drift",
          "[loops][long]") {
  MultiBody body;
  body.gravity = {0, 0, -1};  // the links under this load swing at up to some 100 rad/s
  chain(body, 1000, 0.02, alternating(1, 1e6));
  Simulation simulation(body, "rk4");
  const double energy = simulation.ledger().energy();
  double early = 0, late = 0;
  for (int i = 0; i < 3000; ++i) {
    simulation.step(0.02);
    double& widest = i < 1500 ? early : late;
    widest = std::max(widest, widest_gap(simulation));
  }
  INFO(early << " m in the first half, " << late << " m in the second");
  CHECK(early <= 2e-11);
  CHECK(late <= 2e-11);
  CHECK(std::abs(simulation.ledger().energy() - energy) <= 1e-12 * std::abs(energy));  // the bound is 0.25 J
}

}  // namespace loops_test
