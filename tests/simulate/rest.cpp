// Resting contact: stacks that stand for up to an hour of simulated time, dropped stacks that come to rest,
// sharp shapes on their lowest points, extreme mass ratios.
// N51, N52 and N56 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "deepest.h"
#include "motion.h"

namespace rest_test {

using namespace pliant;

namespace {

constexpr double kSize = 0.1;  // semi-axes of all parts, m

Part& box(MultiBody& body, const std::string& name, const Vec3<double>& at, double density = 1000) {
  Part& part = body.add(make_part(name, "box", {}, density));
  return part.rest({{"a1", kSize}, {"a2", kSize}, {"a3", kSize}}).place(at);
}
void floor(MultiBody& body) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
/// Adds a floor and a stack of boxes, each slightly displaced from the box below. gap: vertical distance (m)
/// between neighbours, and between the floor and the lowest box.
void stack(MultiBody& body, int boxes, double gap = 0) {
  for (int i = 0; i < boxes; ++i)
    box(body, "box" + std::to_string(i), {0.005 * (i % 3), 0, kSize + (2 * kSize + gap) * i + gap});
  floor(body);
}
/// Runs for `time` (s) in steps of h (s). Returns the largest change of any coordinate (m, or 1 for a
/// quaternion) from its initial value. Runs of 2000 or more steps are checked at about a thousand times,
/// shorter runs after every step.
double max_change(Simulation& simulation, double time, double h) {
  const VecX<double> start = simulation.state().q;
  const auto steps = static_cast<int>(std::lround(time / h));
  double max = 0;
  for (int i = 1; i <= steps; ++i) {
    simulation.step(h);
    if (i % std::max(1, steps / 1000) == 0)
      max = std::max(max, (simulation.state().q - start).lpNorm<Eigen::Infinity>());
  }
  return max;
}

}  // namespace

TEST_CASE("N51: a stack of ten boxes stands without creep", "[contact][long]") {
  for (const double h : {2e-3, 2e-2}) {
    MultiBody body;
    stack(body, 10);
    Simulation simulation(body, "rk4");
    CHECK(max_change(simulation, 200 * h, h) < 1e-11 * kSize);
    CHECK(simulation.state().v.norm() < 1e-11);
    CHECK(std::abs(simulation.ledger().balance) < 1e-9);
    CHECK(simulation.step_counters().contact_fallbacks == 0);
  }
}

TEST_CASE("N51: stacks of two and ten boxes stand for an hour, a stack of fifty for ten minutes",
          "[contact][long]") {
  for (const auto& [boxes, hours] : {std::pair(2, 1.0), std::pair(10, 1.0), std::pair(50, 1.0 / 6)}) {
    CAPTURE(boxes);
    MultiBody body;
    stack(body, boxes);
    Simulation simulation(body, "rk4");
    CHECK(max_change(simulation, 3600 * hours, 3e-2) < hours * 1e-6 * kSize);
    CHECK(simulation.state().v.norm() < 1e-9);
    CHECK(std::abs(simulation.ledger().balance) < 1e-6);
  }
}

TEST_CASE("N51: dropped boxes come to rest on each other", "[contact][long]") {
  for (const int boxes : {2, 5, 8}) {
    MultiBody body;
    stack(body, boxes, 1e-4);
    Simulation simulation(body, "rk4");
    const double start = simulation.ledger().energy(), mass = body.parts()[0]->total_mass();
    test::run(simulation, 0.8, 400);
    CAPTURE(boxes);
    CHECK(simulation.state().v.norm() < 1e-12);
    double energy_loss = 0;  // energy lost in all the gaps, J
    for (int i = 1; i <= boxes; ++i) energy_loss += mass * 9.81 * 1e-4 * i;
    CHECK(start - simulation.ledger().energy() == Approx(energy_loss).epsilon(2e-2));
    CHECK(test::deepest_overlap(simulation) < 1e-9 * kSize);
  }
}

TEST_CASE("N52: a sharp corner, an edge and a tip touch the plane with their lowest points",
          "[contact][long]") {
  struct Orientation {
    const char* name;
    Eigen::Quaterniond R;
    /// Whether a solid with eps < 1 (nearly a cube) stands on a point or a line, so that it falls over in
    /// time.
    bool unstable;
  };
  const std::vector<Orientation> orientations{
      {"face", Eigen::Quaterniond::Identity(), false},
      {"edge", Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 4, Vec3<double>::UnitX())), true},
      {"corner",
       Eigen::Quaterniond::FromTwoVectors(Vec3<double>(1, 1, 1).normalized(), Vec3<double>(0, 0, -1)), true}};
  for (const double eps : {0.02, 0.1, 0.2, 1.99, 2.0})
    for (const Orientation& orientation : orientations) {
      // The support function of |x|^(2/eps) + |y|^(2/eps) + |z|^(2/eps) = a^(2/eps) is the dual norm.
      auto support = [&](const Eigen::Quaterniond& R) {
        const Vec3<double> d = (R.conjugate() * Vec3<double>(0, 0, -1)).cwiseAbs();
        if (eps == 2) return kSize * d.maxCoeff();
        const double p = 2 / (2 - eps), most = d.maxCoeff();
        return kSize * most * std::pow((d / most).array().pow(p).sum(), 1 / p);
      };
      MultiBody body;
      body.contact.friction = 0.6;
      Part& part = body.add(make_part("solid", "superellipsoid", {}, 1000));
      part.rest({{"a1", kSize}, {"a2", kSize}, {"a3", kSize}, {"eps1", eps}, {"eps2", eps}});
      part.place({0, 0, support(orientation.R)}, orientation.R);
      floor(body);
      Simulation simulation(body, "rk4");
      CAPTURE(eps, orientation.name);
      const std::vector<Contact> contacts =
          ContactFinder(simulation.model()).find(simulation.state(), 0, 1e-3);
      REQUIRE_FALSE(contacts.empty());
      double min_gap = 1;
      for (const Contact& contact : contacts) min_gap = std::min(min_gap, contact.gap);
      CHECK(std::abs(min_gap) < 1e-6 * kSize);
      // With eps near 2 the solid is nearly an octahedron: with its "corner" down it stands on a face, with
      // its "edge" down on an edge, with its "face" down on a tip. A solid that stands on a point or a line
      // may start to fall over, so its speed has the larger limit. The exception is the edge of the
      // octahedron: there the solid stays within the smaller limit for the 0.5 s of the test.
      const bool flat = eps > 1 ? std::string(orientation.name) != "face" : !orientation.unstable;
      for (int i = 0; i < 250; ++i) {
        simulation.step(2e-3);
        REQUIRE(support(simulation.model().orientation(simulation.state(), 0)) - simulation.state().q[2] <
                1e-6 * kSize);
        REQUIRE(simulation.state().v.norm() < (flat ? 1e-5 : 0.1));
      }
    }
}

TEST_CASE(
    "N56: with mass ratios of a million, heavy on light or light on heavy, boxes rest without deep overlap",
    "[contact][long]") {
  for (const double ratio : {1e-6, 1e6})
    for (const double h : {1e-3, 2e-3}) {
      MultiBody body;
      box(body, "low", {0, 0, kSize}, ratio < 1 ? 1 / ratio : 1);
      box(body, "high", {0.01, 0, 3 * kSize + 1e-3}, ratio < 1 ? 1 : ratio);
      floor(body);
      Simulation simulation(body, "rk4");
      double deep = 0;
      for (int i = 0; i < 400; ++i) {
        simulation.step(h);
        deep = std::max(deep, test::deepest_overlap(simulation));
      }
      CAPTURE(ratio, h);
      CHECK(deep < 1e-3 * kSize);
      CHECK(simulation.state().q[7 + 2] == Approx(3 * kSize).epsilon(1e-9));
      CHECK(simulation.state().v.norm() < 1e-8);
      CHECK(std::abs(simulation.ledger().balance) <
            1e-9 * std::abs(simulation.ledger().work[static_cast<int>(Work::contact)]) + 1e-9);
    }
}

}  // namespace rest_test
