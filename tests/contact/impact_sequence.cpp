// Impacts of bodies in a row that touch: Newton's cradle with both laws of ContactSettings::impacts. The law
// "simultaneous" applies Newton's law of restitution at all contacts at once. With the law "sequential",
// impacts of two bodies follow each other, which gives the classical motion of a cradle.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <pliant/contact/contact_stepping.h>

#include "motion.h"

namespace impact_sequence_test {

using namespace pliant;

namespace {

constexpr double kRadius = 0.125, kSpeed = 2, kGap = 0.01;  // m, m/s, m

/// A row of balls along x, without gravity. The first `moving` balls touch each other, and the other balls
/// touch each other. The first balls approach the other balls, which are at rest, from the distance kGap with
/// the speed kSpeed.
struct Row {
  std::vector<double> densities;  ///< kg/m^3, of each ball
  int moving = 1;
  double restitution = 1;
  ImpactOrder impacts = ImpactOrder::sequential;
  /// Number of balls at rest far away. With more than eight parts, the times of impacts are not located.
  int bystanders = 0;

  int size() const { return static_cast<int>(densities.size()); }
  void build(MultiBody& body) const {
    body.gravity.setZero();
    body.contact.active = true;
    body.contact.restitution = restitution;
    body.contact.impacts = impacts;
    for (int i = 0; i < size(); ++i) {
      const bool moves = i < moving;
      body.add(make_part("ball" + std::to_string(i), "sphere", {}, densities[static_cast<std::size_t>(i)]))
          .rest({{"r", kRadius}})
          .place({2 * kRadius * i - (moves ? kGap : 0), 0, 0})
          .velocity({moves ? kSpeed : 0, 0, 0}, {0, 0, 0});
    }
    for (int i = 0; i < bystanders; ++i)
      body.add(make_part("bystander" + std::to_string(i), "sphere", {}, 1000))
          .rest({{"r", kRadius}})
          .place({0, 10.0 + i, 0});
  }
};

/// The velocities of the balls of a row along x after the impacts, m/s, and the counters of the run.
struct Outcome {
  std::vector<double> velocities;
  StepCounters counters;
};

/// Simulates a row until shortly after its impacts. Checks that the momentum is conserved, that the energy
/// does not increase, and that no ball leaves the line of the row or rotates.
Outcome outcome(const Row& row, double tolerance = 0) {
  MultiBody body;
  row.build(body);
  Simulation simulation(body, tolerance > 0 ? "dop853" : "rk4", 1, tolerance);
  const double end = 1.3 * kGap / kSpeed, energy = simulation.ledger().kinetic;
  auto momentum = [&] {
    double sum = 0;
    for (const PartModel& m : simulation.model().parts())
      sum += m.part->total_mass() * simulation.state().v[m.v0];
    return sum;
  };
  const double momentum_before = momentum();
  while (simulation.time() < end) {
    if (tolerance > 0)
      simulation.step_up_to(end);
    else
      simulation.step(7e-4);
  }
  const double kept = simulation.ledger().kinetic / energy;
  CHECK(kept <= 1 + 1e-12);
  CHECK(std::abs(simulation.ledger().balance) < 1e-12 * energy);
  CHECK(momentum() == Approx(momentum_before).epsilon(1e-13));
  if (row.restitution == 1 && row.impacts == ImpactOrder::sequential) CHECK(kept == Approx(1).epsilon(1e-10));
  Outcome result{{}, simulation.step_counters()};
  for (int i = 0; i < row.size(); ++i) {
    const PartModel& m = simulation.model().parts()[static_cast<std::size_t>(i)];
    auto v = simulation.state().v.segment<6>(m.v0);
    result.velocities.push_back(v[0]);
    CHECK(v.tail<5>().norm() < 1e-12);
  }
  return result;
}

/// Returns the velocities after the impacts of a row, computed by impacts of two balls in one dimension: the
/// pair that approaches fastest comes first.
std::vector<double> chain(const Row& row) {
  std::vector<double> v;
  for (int i = 0; i < row.size(); ++i) v.push_back(i < row.moving ? kSpeed : 0);
  for (;;) {
    std::size_t next = 0;
    double fastest = 1e-11;
    for (std::size_t i = 0; i + 1 < v.size(); ++i)
      if (v[i] - v[i + 1] > fastest) {
        next = i;
        fastest = v[i] - v[i + 1];
      }
    if (fastest == 1e-11) return v;
    const double m = row.densities[next], M = row.densities[next + 1],
                 p = (1 + row.restitution) * fastest * m * M / (m + M);
    v[next] -= p / m;
    v[next + 1] += p / M;
  }
}

}  // namespace

TEST_CASE("sequential impacts: as many equal balls leave a cradle as have hit it", "[contact]") {
  for (const double tolerance : {0.0, 1e-8})
    for (const int bystanders : {0, 8})
      for (int n = 2; n <= 7; ++n)
        for (int moving = 1; moving < n; ++moving) {
          CAPTURE(tolerance, bystanders, n, moving);
          Row row{std::vector<double>(static_cast<std::size_t>(n), 1000), moving};
          row.bystanders = bystanders;
          const Outcome result = outcome(row, tolerance);
          for (int i = 0; i < n; ++i)
            CHECK(result.velocities[static_cast<std::size_t>(i)] ==
                  Approx(i < n - moving ? 0 : kSpeed).margin(1e-9 * kSpeed));
          CHECK(result.counters.contact_cutoffs == 0);
          CHECK(result.counters.sequential_impacts >= n - 1);
        }
}

TEST_CASE("sequential impacts: rows of unequal balls move as chains of impacts of two bodies", "[contact]") {
  const std::vector<std::vector<double>> rows{
      {1000, 3000, 500}, {4000, 2000, 1000, 500}, {500, 1000, 2000, 4000}, {1000, 200, 5000, 300, 1000}};
  for (const double e : {1.0, 0.8, 0.5, 0.0})
    for (const std::vector<double>& densities : rows)
      for (int moving = 1; moving < static_cast<int>(densities.size()); ++moving) {
        CAPTURE(e, densities, moving);
        const Row row{densities, moving, e};
        const Outcome result = outcome(row);
        const std::vector<double> expected = chain(row);
        for (std::size_t i = 0; i < expected.size(); ++i)
          CHECK(result.velocities[i] == Approx(expected[i]).margin(1e-8 * kSpeed));
        CHECK(result.counters.contact_cutoffs == 0);
      }
}

TEST_CASE("simultaneous impacts: all balls of a cradle after the first leave together", "[contact]") {
  // Newton's law of restitution at all contacts at once: the first ball separates from the second with e
  // times its approach speed. At the other contacts the balls do not approach before the impact, and do not
  // separate after it.
  for (const double e : {1.0, 0.5, 0.0})
    for (int n = 2; n <= 7; ++n) {
      CAPTURE(e, n);
      Row row{std::vector<double>(static_cast<std::size_t>(n), 1000), 1, e};
      row.impacts = ImpactOrder::simultaneous;
      const Outcome result = outcome(row);
      const double together = (1 + e) * kSpeed / n;
      CHECK(result.velocities[0] == Approx(together - e * kSpeed).margin(1e-9 * kSpeed));
      for (std::size_t i = 1; i < result.velocities.size(); ++i)
        CHECK(result.velocities[i] == Approx(together).margin(1e-9 * kSpeed));
      CHECK(result.counters.sequential_impacts == 0);
    }
}

TEST_CASE("sequential impacts: a ball between a wall and a heavy ball; the number of impacts is bounded",
          "[contact]") {
  // With masses of ratio 100^d, the number of impacts of the light ball has the first d + 1 digits of pi
  // (Galperin 2003). A sequence with two pairs has at most 1020 impacts; further impacts have no rebound.
  const long most = 1020;
  for (const auto& [ratio, impacts] :
       std::vector<std::pair<double, long>>{{1, 3}, {100, 31}, {1e4, 314}, {1e6, most}}) {
    CAPTURE(ratio);
    MultiBody body;
    body.gravity.setZero();
    body.contact.restitution = 1;
    body.contact.impacts = ImpactOrder::sequential;
    Part& light = body.add(make_part("light", "sphere", {}, 1000));
    light.rest({{"r", kRadius}}).place({kRadius, 0, 0});
    Part& heavy = body.add(make_part("heavy", "sphere", {}, 1000 * ratio));
    heavy.rest({{"r", kRadius}}).place({3 * kRadius + kGap, 0, 0}).velocity({-kSpeed, 0, 0}, {0, 0, 0});
    body.plane("wall", Vec3<double>(0, 0, 0), {1, 0, 0});
    Simulation simulation(body, "rk4");
    const double energy = simulation.ledger().kinetic;
    while (simulation.step_counters().impacts == 0) {
      REQUIRE(simulation.time() < 0.02);
      simulation.step(7e-4);
    }
    // After a sequence that has reached its limit, another sequence may follow in the same step.
    CHECK(simulation.step_counters().sequential_impacts % most == impacts % most);
    CHECK((simulation.step_counters().contact_cutoffs > 0) == (impacts == most));
    CHECK(simulation.ledger().kinetic <= (1 + 1e-9) * energy);
    CHECK(simulation.state().v[0] > -1e-9 * kSpeed);  // no pair approaches any more
    CHECK(simulation.state().v[6] - simulation.state().v[0] > -1e-9 * kSpeed);
    if (impacts == most) continue;
    CHECK(simulation.ledger().kinetic == Approx(energy).epsilon(1e-8));
    // The heavy ball has the mass M and the velocity V, the light ball m and v. Two successive impacts rotate
    // (sqrt(M) V, sqrt(m) v) by the angle 2 arctan sqrt(m / M).
    const double angle = static_cast<double>(impacts + impacts % 2) * std::atan(1 / std::sqrt(ratio));
    CHECK(std::abs(simulation.state().v[6]) ==
          Approx(std::abs(std::cos(angle)) * kSpeed).margin(1e-8 * kSpeed));
  }
}

TEST_CASE("sequential impacts with friction keep the momenta and lose energy", "[contact]") {
  for (const int bystanders : {0, 6})
    for (const double e : {1.0, 0.5}) {
      CAPTURE(bystanders, e);
      MultiBody body;
      body.gravity.setZero();
      body.contact.active = true;
      body.contact.restitution = e;
      body.contact.friction = 0.3;
      body.contact.impacts = ImpactOrder::sequential;
      const double side = 2 * kRadius, height = side * std::sqrt(0.75);
      const std::vector<Vec3<double>> tetrahedron{{0, 0, 0},
                                                  {side, 0, 0},
                                                  {0.5 * side, height, 0},
                                                  {0.5 * side, height / 3, side * std::sqrt(2.0 / 3)}};
      for (std::size_t i = 0; i < tetrahedron.size(); ++i)
        body.add(make_part("ball" + std::to_string(i), "sphere", {}, 1000 + 500 * static_cast<double>(i)))
            .rest({{"r", kRadius}})
            .place(tetrahedron[i]);
      body.add(make_part("fast", "sphere", {}, 2000))
          .rest({{"r", kRadius}})
          .place({-side - 0.02, 0.03, 0.02})
          .velocity({5, 0.3, 0}, {2, 5, -3});
      for (int i = 0; i < bystanders; ++i)
        body.add(make_part("bystander" + std::to_string(i), "sphere", {}, 1000))
            .rest({{"r", kRadius}})
            .place({0, 10.0 + i, 0});
      Simulation simulation(body, "dop853", 1, 1e-8);
      const Ledger start = simulation.ledger();
      while (simulation.step_counters().sequential_impacts == 0) {
        REQUIRE(simulation.time() < 0.01);
        simulation.step_up_to(0.01);
      }
      const Ledger end = simulation.ledger();
      CHECK((end.momentum - start.momentum).norm() < 1e-13 * start.momentum.norm());
      // Impacts that are not located also displace the balls, which changes the angular momentum.
      if (bystanders == 0)
        CHECK((end.angular_momentum - start.angular_momentum).norm() < 1e-12 * start.angular_momentum.norm());
      CHECK(end.kinetic < 0.99 * start.kinetic);
      CHECK(simulation.step_counters().sequential_impacts > 3);
      CHECK(simulation.step_counters().contact_cutoffs == 0);
    }
}

namespace {

/// A body of a scene without gravity and friction: its place (m) and its velocity (m/s).
struct Thrown {
  Vec3<double> place, velocity;
  double density = 1000;  ///< kg/m^3
};

/// Adds bodies of a shape, each named by its number, and eight bystanders, so that impacts are not located.
void throw_bodies(MultiBody& body, const std::string& shape, const std::vector<Thrown>& thrown) {
  body.gravity.setZero();
  body.contact.active = true;
  body.contact.friction = 0;
  body.contact.restitution = 1;
  body.contact.impacts = ImpactOrder::sequential;
  auto add = [&](const std::string& name, const Thrown& one) {
    Part& part = body.add(make_part(name, shape, {}, one.density));
    if (shape == "sphere")
      part.rest({{"r", kRadius}});
    else
      part.rest({{"a1", kRadius}, {"a2", kRadius}, {"a3", kRadius}});
    part.place(one.place).velocity(one.velocity, {0, 0, 0});
  };
  for (std::size_t i = 0; i < thrown.size(); ++i) add(std::to_string(i), thrown[i]);
  for (int i = 0; i < 8; ++i) add("bystander" + std::to_string(i), {{0, 10.0 + i, 0}, {0, 0, 0}});
}

/// Returns the velocity of a part along x, m/s.
double speed_of(const Simulation& simulation, std::size_t part) {
  return simulation.state().v[simulation.model().parts()[part].v0];
}

}  // namespace

TEST_CASE("sequential impacts that are not located: an earlier impact changes the approach", "[contact]") {
  // The second ball is slow at first. After the first impact, it approaches the third ball ten times as fast.
  MultiBody rising;
  throw_bodies(rising, "sphere",
               {{{-2 * kRadius - 5e-3, 0, 0}, {10, 0, 0}},
                {{0, 0, 0}, {1, 0, 0}},
                {{2 * kRadius + 5e-4, 0, 0}, {0, 0, 0}}});
  Simulation row(rising, "rk4");
  row.step(7e-4);
  CHECK(row.step_counters().impacts == 0);
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(speed_of(row, i) == Approx(std::vector<double>{0, 1, 10}[i]).margin(1e-10));

  // The third ball pushes the second ball obliquely away from the first ball. The approach speed of the first
  // and second balls falls to a third.
  const double angle = 70 * kPi / 180;
  const Vec3<double> along(std::cos(angle), std::sin(angle), 0);
  MultiBody falling;
  throw_bodies(falling, "sphere",
               {{{-2 * kRadius - 2e-4, 0, 0}, {1, 0, 0}},
                {{0, 0, 0}, {0, 0, 0}},
                {-(2 * kRadius + 5e-4) * along, 2 * along}});
  Simulation oblique(falling, "rk4");
  const Ledger before = oblique.ledger();
  oblique.step(7e-4);
  CHECK(oblique.step_counters().sequential_impacts >= 2);
  CHECK(oblique.ledger().kinetic == Approx(before.kinetic).epsilon(1e-10));
  CHECK((oblique.ledger().momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
}

TEST_CASE("sequential impacts that are not located: a dropped ball rebounds without gain of energy",
          "[contact]") {
  for (const double e : {1.0, 0.5}) {
    std::vector<double> speeds;
    for (const ImpactOrder order : {ImpactOrder::simultaneous, ImpactOrder::sequential}) {
      MultiBody body;
      throw_bodies(body, "sphere", {{{0, 0, kRadius + 5e-4}, {0, 0, -1}}});
      body.contact.restitution = e;
      body.contact.impacts = order;
      body.gravity = Vec3<double>(0, 0, -1000);
      body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
      Simulation simulation(body, "rk4");
      simulation.step(7e-4);
      speeds.push_back(simulation.state().v[2]);
    }
    CAPTURE(e);
    CHECK(speeds[0] > 0.1);
    CHECK(speeds[1] == Approx(speeds[0]).epsilon(1e-12));
  }
}

TEST_CASE("sequential impacts that are not located: bodies that separate cause no sequence", "[contact]") {
  // Two balls that rest on the floor, and touch, separate slowly. The contacts with the floor are resolved
  // once.
  MultiBody body;
  throw_bodies(body, "sphere",
               {{{0, 0, kRadius}, {-3e-5, 0, 0}}, {{2 * kRadius - 1e-7, 0, kRadius}, {3e-5, 0, 0}}});
  body.gravity = Vec3<double>(0, 0, -9.81);
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  Simulation simulation(body, "rk4");
  simulation.step(1e-3);
  const std::vector<Contact>& contacts = simulation.contact()->contacts();
  CHECK(std::any_of(contacts.begin(), contacts.end(), [](const Contact& c) { return c.b.part == 1; }));
  CHECK(std::count_if(contacts.begin(), contacts.end(),
                      [](const Contact& c) { return c.a.part < 2 && c.plane == 0; }) == 2);
}

TEST_CASE("sequential impacts to a tolerance of contact: residual velocities cause no further impact",
          "[contact]") {
  // Faces of boxes touch at four contacts, at which the solver leaves velocities within the tolerance.
  for (const double tolerance : {1e-4, 1e-2, 0.1})
    for (int n = 3; n <= 6; ++n) {
      CAPTURE(tolerance, n);
      std::vector<Thrown> row;
      for (int i = 0; i < n; ++i)
        row.push_back({{2 * kRadius * i - (i == 0 ? 1e-3 : 0), 0, 0}, {i == 0 ? kSpeed : 0, 0, 0}});
      MultiBody body;
      throw_bodies(body, "box", row);
      body.contact.tolerance = tolerance;
      Simulation simulation(body, "rk4");
      simulation.step(7e-4);
      CHECK(simulation.step_counters().sequential_impacts == n - 1);
      for (int i = 0; i < n; ++i)
        CHECK(speed_of(simulation, static_cast<std::size_t>(i)) ==
              Approx(i < n - 1 ? 0 : kSpeed).margin(2 * tolerance * kSpeed));
    }
}

TEST_CASE("sequential impacts to a tolerance of contact: slow bodies rebound while others are fast",
          "[contact]") {
  const double far = 5;
  std::vector<Thrown> thrown;
  for (const double speed : {20.0, 0.1})
    for (int i = 0; i < 2; ++i)
      thrown.push_back({{(2 * kRadius + 3e-5) * i, speed == 20 ? 0 : far, 0}, {i == 0 ? speed : 0, 0, 0}});
  MultiBody body;
  throw_bodies(body, "sphere", thrown);
  body.contact.tolerance = 0.01;
  Simulation simulation(body, "rk4");
  simulation.step(7e-4);
  CHECK(speed_of(simulation, 1) == Approx(20));
  CHECK(speed_of(simulation, 2) == Approx(0).margin(1e-6));
  CHECK(speed_of(simulation, 3) == Approx(0.1));
}

TEST_CASE("sequential impacts to a tolerance of contact: a mirrored scene stays mirrored", "[contact]") {
  // Two fast boxes meet a row from both ends. The box in the middle is heavy, so that the order of its two
  // impacts would matter. These two impacts must be simultaneous.
  for (const double tolerance : {1e-6, 1e-3, 1e-2}) {
    CAPTURE(tolerance);
    MultiBody body;
    throw_bodies(body, "box",
                 {{{-4 * kRadius - 1e-3, 0.03, 0.05}, {kSpeed, 0, 0}},
                  {{-2 * kRadius, 0.01, -0.02}, {0, 0, 0}},
                  {{0, 0, 0}, {0, 0, 0}, 3000},
                  {{4 * kRadius + 1e-3, 0.03, 0.05}, {-kSpeed, 0, 0}},
                  {{2 * kRadius, 0.01, -0.02}, {0, 0, 0}}});
    body.contact.tolerance = tolerance;
    Simulation simulation(body, "rk4");
    simulation.step(7e-4);
    CHECK(simulation.step_counters().sequential_impacts > 1);
    CHECK(std::abs(speed_of(simulation, 2)) < 20 * tolerance * kSpeed);
    CHECK(std::abs(speed_of(simulation, 0) + speed_of(simulation, 3)) < 20 * tolerance * kSpeed);
    CHECK(std::abs(speed_of(simulation, 1) + speed_of(simulation, 4)) < 20 * tolerance * kSpeed);
  }
}

TEST_CASE("sequential impacts of discarded steps are not counted", "[contact]") {
  // Balls on a floor: steps with resting contacts are repeated as two halves.
  MultiBody body;
  body.contact.active = true;
  body.contact.friction = 0;
  body.contact.restitution = 1;
  body.contact.impacts = ImpactOrder::sequential;
  for (int i = 0; i < 3; ++i)
    body.add(make_part("ball" + std::to_string(i), "sphere", {}, 1000))
        .rest({{"r", kRadius}})
        .place({2 * kRadius * i - (i == 0 ? kGap : 0), 0, kRadius})
        .velocity({i == 0 ? kSpeed : 0, 0, 0}, {0, 0, 0});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  Simulation simulation(body, "dop853", 1, 1e-8);
  while (simulation.time() < 2 * kGap / kSpeed) simulation.step_up_to(2 * kGap / kSpeed);
  CHECK(speed_of(simulation, 2) == Approx(kSpeed));
  CHECK(simulation.step_counters().impacts == 1);
  CHECK(simulation.step_counters().sequential_impacts == 2);
}

}  // namespace impact_sequence_test
