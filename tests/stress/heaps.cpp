// Balls are packed densely between a floor and four walls, with about five thousand simultaneous contacts.
// The tests check the accuracy of the impulses, the memory, and the growth of the time with the number of
// contacts. Other tests use piles and a poured heap.
// N55 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <string>

#include <malloc.h>
#include <unistd.h>

#include <pliant/contact/contact_problem.h>
#include <pliant/contact/contact_stepping.h>

#include "draws.h"
#include "motion.h"

namespace stress_heaps_test {

using namespace pliant;

namespace {

constexpr double kG = 9.81, kStep = 2e-3, kRadius = 0.1;  // m/s^2, s, m

/// Adds a square layer of across x across balls that touch their neighbours. first: position of the first
/// ball, m.
void layer(MultiBody& body, int across, const Vec3<double>& first) {
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < across; ++j)
      body.add(make_part("ball" + std::to_string(body.parts().size()), "sphere", {}, 1000))
          .rest({{"r", kRadius}})
          .place(first + 2 * kRadius * Vec3<double>(i, j, 0));
}
void floor(MultiBody& body) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
/// Adds a floor and four walls.
void walls(MultiBody& body, double width) {
  floor(body);
  body.plane("west", Vec3<double>(0, 0, 0), {1, 0, 0});
  body.plane("east", Vec3<double>(width, 0, 0), {-1, 0, 0});
  body.plane("south", Vec3<double>(0, 0, 0), {0, 1, 0});
  body.plane("north", Vec3<double>(0, width, 0), {0, -1, 0});
}
/// Adds five layers of balls between a floor and four walls. across: number of balls along each edge of the
/// lowest layer. Each ball above this layer is in the hollow between four balls below.
void pack(MultiBody& body, int across) {
  for (int k = 0; k < 5; ++k) {
    const double in = kRadius * (1 + k % 2);
    layer(body, across - k % 2, {in, in, kRadius * (1 + k * std::sqrt(2.0))});
  }
  walls(body, 2 * kRadius * across);
}
/// Returns the number of contacts of `pack`: within layers, between layers, on the floor and the walls.
std::size_t packed_contacts(int across) {
  const int n = across, m = n - 1;
  return static_cast<std::size_t>(3 * 2 * n * (n - 1) + 2 * 2 * m * (m - 1) + 4 * 4 * m * m + n * n +
                                  4 * 3 * n);
}
/// Adds a floor and a pyramid of `across` layers of balls. Each layer has one ball fewer along each edge than
/// the layer below.
void pile(MultiBody& body, int across) {
  for (int k = 0; k < across; ++k)
    layer(body, across - k, kRadius * Vec3<double>(k, k, 1 + k * std::sqrt(2.0)));
  floor(body);
}
/// Returns the resident memory of the process, bytes.
double resident_memory() {
  double all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}
/// Returns the allocated heap memory, bytes. Unlike the resident memory, the allocated memory does not depend
/// on fragmentation.
double heap_memory() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}
/// Performs `steps` steps and returns the shortest processor time of one of them, s.
double min_step_time(Simulation& simulation, int steps) {
  double min_time = kInfinity;
  for (int i = 0; i < steps; ++i) {
    const std::clock_t start = std::clock();
    simulation.step(kStep);
    min_time = std::min(min_time, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return min_time;
}

}  // namespace

TEST_CASE("N55: five thousand contacts of balls packed in a box are solved to rounding", "[contact]") {
  MultiBody body;
  pack(body, 14);
  Simulation simulation(body, "rk4");
  const VecX<double> start = simulation.state().q;
  double weight = 0;
  for (const auto& part : body.parts()) weight += kG * part->total_mass();
  for (int i = 0; i < 4; ++i) {
    simulation.step(kStep);
    const ContactRecord& record = simulation.contact()->record();
    REQUIRE(record.contacts.size() == packed_contacts(14));
    REQUIRE(record.contacts.size() > 4700);
    double vertical_impulse = 0;
    for (std::size_t k = 0; k < record.contacts.size(); ++k) {
      if (record.contacts[k].plane >= 0) vertical_impulse += record.impulses[k][2];  // walls exert friction
    }
    CHECK(vertical_impulse == Approx(weight * kStep).epsilon(1e-11));
  }
  CHECK((simulation.state().q - start).lpNorm<Eigen::Infinity>() < 1e-14);
  CHECK(simulation.state().v.lpNorm<Eigen::Infinity>() < 5e-14);
  CHECK(simulation.step_counters().contact_residual < 1e-14);  // m/s; 3e-15 has been observed
  CHECK(simulation.step_counters().contact_fallbacks == 0);
}

TEST_CASE("N55: if the contacts of a pile are not solved to rounding, the residual is reported",
          "[contact]") {
  for (const int across : {3, 5, 9, 14}) {
    MultiBody body;
    body.contact.friction = 1;
    pile(body, across);
    const Model model(body);
    const Dynamics dynamics(model);
    State state = model.initial_state();
    std::vector<int> all;
    for (const PartModel& m : model.parts()) {
      all.push_back(static_cast<int>(all.size()));
      state.v[m.v0 + 2] = -kG * kStep;
    }
    Workspace<double> work;
    dynamics.accelerations(0, state.q, state.v, state, work);
    dynamics.evaluate_masses(state.time(), state.q, state.v, all, work);
    const std::vector<Contact> contacts = ContactFinder(model).find(state, 0, 1e-9);
    ContactProblem problem(model, state, work, contacts);
    const ContactSolution solution = problem.solve(0);
    double max_violation = 0;  // largest violation of the velocity conditions, m/s
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const Vec3<double>&p = solution.impulse[k], &u = solution.velocity[k], &n = contacts[k].normal;
      const double p_n = p.dot(n), u_n = u.dot(n), p_t = (p - p_n * n).norm();
      REQUIRE(p_n >= -1e-9);
      REQUIRE(p_t <= contacts[k].friction * p_n * (1 + 1e-9) + 1e-6);
      max_violation = std::max(max_violation, -u_n);
      if (p_n > 1e-6) max_violation = std::max(max_violation, u_n);
      if (p_t < (1 - 1e-6) * contacts[k].friction * p_n - 1e-6)
        max_violation = std::max(max_violation, (u - u_n * n).norm());
    }
    CAPTURE(across, contacts.size(), solution.residual);
    CHECK(max_violation < 3 * solution.residual + 1e-9);
    CHECK(solution.residual < 0.5 * kG * kStep);
    CHECK((solution.residual <= 1e-6) == (solution.fallbacks == 0));
    if (across == 3) CHECK(solution.residual < 1e-15);
  }
}

TEST_CASE("N55: a poured heap comes to rest without penetration", "[contact][long]") {
  MultiBody body;
  constexpr int across = 4, layers = 10;
  test::Draws draws(3);
  for (int k = 0; k < layers; ++k)
    for (int i = 0; i < across * across; ++i) {
      const double size = draws.uniform(0.07, 0.09);
      body.add(make_part("pebble" + std::to_string(body.parts().size()), "ellipsoid", {}, 1000))
          .rest({{"a1", size}, {"a2", 0.83 * size}, {"a3", 0.65 * size}})
          .place({0.1 + 0.2 * (i % across) + draws.uniform(0, 5e-3), 0.1 + 0.2 * (i / across), 0.1 + 0.2 * k},
                 Eigen::Quaterniond(draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1), 1)
                     .normalized());
    }
  walls(body, 0.2 * across);
  body.contact.friction = 0.4;
  Simulation simulation(body, "rk4");
  double deepest = 0;
  // Means of the last quarter of a second, m/s: the median of the speeds, and the speed that a tenth of the
  // parts exceeds.
  double median = 0, fast = 0;
  std::vector<double> speeds(body.parts().size());
  while (simulation.time() < 2) {
    simulation.step(kStep);
    for (const Contact& contact : simulation.contact()->overlaps(simulation.state(), simulation.time()))
      deepest = std::max(deepest, -contact.gap);
    if (simulation.time() < 1.75) continue;
    for (std::size_t i = 0; i < speeds.size(); ++i)
      speeds[i] = simulation.state().v.segment<3>(simulation.model().parts()[i].v0).norm();
    std::sort(speeds.begin(), speeds.end());
    median += kStep / 0.25 * speeds[speeds.size() / 2];
    fast += kStep / 0.25 * speeds[9 * speeds.size() / 10];
  }
  REQUIRE(simulation.state().contact_residual > 0);
  Simulation resumed(body, "rk4");
  resumed.set_state(simulation.state());
  for (Simulation* each : {&simulation, &resumed})
    for (int i = 0; i < 3; ++i) each->step(kStep);
  CHECK(hash(resumed.state()) == hash(simulation.state()));
  CAPTURE(deepest, median, fast, speeds.back());
  CHECK(deepest < 1e-9);
  // Single pebbles still rock, and shake their neighbours.
  CHECK(median < 3e-4);
  CHECK(fast < 1e-2);
}

TEST_CASE(
    "N55: memory for five thousand contacts is bounded, and time grows almost in proportion to their number",
    "[contact][long]") {
  MultiBody few, many;
  pack(few, 7);
  pack(many, 14);
  Simulation small(few, "rk4");
  small.step(kStep);
  const double before = resident_memory();
  Simulation large(many, "rk4");
  min_step_time(large, 5);
  CHECK(resident_memory() - before < 110e6);  // 40 MB have been observed, 8 kB for each contact
  min_step_time(small, 5);
  const double after = heap_memory();
  double time_small = kInfinity, time_large = kInfinity;
  for (int i = 0; i < 4; ++i) {
    time_small = std::min(time_small, min_step_time(small, 5));
    time_large = std::min(time_large, min_step_time(large, 5));
  }
  CAPTURE(heap_memory() - after);
  // Later steps allocate almost no further memory: 0.5 kB has been observed.
  CHECK(heap_memory() - after < 1e5);
  const double growth = static_cast<double>(many.parts().size()) / static_cast<double>(few.parts().size());
  CAPTURE(growth, time_small, time_large);
  // The time has been observed to grow with the number of parts to the power 1.2.
  CHECK(time_large < std::pow(growth, 1.5) * time_small);
  const auto sweeps = [](const Simulation& simulation) {
    return static_cast<double>(simulation.step_counters().contact_sweeps) /
           static_cast<double>(simulation.step_counters().steps);
  };
  CHECK(sweeps(large) < std::pow(growth, 0.3) * sweeps(small));
}

}  // namespace stress_heaps_test
