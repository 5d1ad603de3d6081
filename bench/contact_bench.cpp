// Run time of contact per body and step. Solids of every shape, with and without deformations, fall onto a
// plane side by side or as a heap of five layers, or fall into the hollows of a mesh. In other systems
// springs press pairs of solids together, or towers and pyramids of ten boxes stand (contact_systems.h). The
// runs last from the first impacts until most bodies are at rest. The program also measures the exponent with
// which the run time grows with the number of bodies, and the time of each stage.
//
//   contact_bench [FOLDER] [MAX] [NAME] [SECONDS] [TOLERANCE]
//
// Writes contact_bench.csv and contact_exponents.csv to FOLDER and a table to standard output. MAX: the
// largest number of bodies (default: 10000). NAME: measures only the systems whose name contains this text.
// SECONDS: if the run with ten times as many bodies would probably take longer than this time, the system is
// not measured with more bodies (default: 60). TOLERANCE: ContactSettings::tolerance; 0: contact has no
// tolerance (default).
//
// Columns of the table, with the names of the columns of the files if they differ:
//   step               mean time of a step in the whole run (step_us_per_body)
//   at rest            mean time of a step in the last tenth of the run (still_step_us_per_body)
//   warm               a step at the end that is warm-started from the contact cache (begun_us)
//   cold               a step at the end without the cache (anew_us); in a run, one step in eleven is cold
//   asleep             a step at the end in which all bodies sleep, an option of scenes
//   motion             stage of a step at the end: the method of integration without contact
//   near, find, solve  stages of a step at the end: candidate pairs, contacts, impulses
//   deepest            largest depth of a contact in the run / 0.1 m (deepest_in_sizes)
//   residual           largest residual of a contact solution, m/s
//   fallbacks          solutions of contact clusters repeated with compliant contacts (step_counters.h)
//
// The stages are timed one by one in separate loops, so their data are in the processor caches.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <pliant/contact/contact_stepping.h>
#include <pliant/pliant.h>

#include "contact_systems.h"
#include "exponent.h"
#include "table_file.h"
#include "timing.h"

using namespace pliant;
using bench::System;

namespace {

constexpr double kStep = 2e-3, kDuration = 1, kBodySize = 0.1;  // s, s, m

/// A row of the table. Times are in microseconds per body and step.
struct Cost {
  std::string system;
  int bodies = 0, contacts = 0;
  double warm = 0, cold = 0;
  double step = 0, resting_step = 0;  ///< means over the whole run, and over its last tenth
  double asleep = 0;                  ///< a step in which all bodies sleep
  double motion = 0, near = 0, find = 0, solve = 0;
  double deepest = 0;   ///< largest depth of a contact in the run / kBodySize
  double residual = 0;  ///< m/s
  long fallbacks = 0;
};

/// Simulates the whole run and measures its steps. Returns the processor time of the run, s.
double measure_run(Simulation& simulation, Cost& cost) {
  const int steps = static_cast<int>(std::lround(kDuration / kStep)), resting = steps / 10;
  double seconds = 0, resting_seconds = 0;
  for (int i = 0; i < steps; ++i) {
    const auto start = bench::ProcessorClock::now();
    simulation.step(kStep);
    const double duration = std::chrono::duration<double>(bench::ProcessorClock::now() - start).count();
    seconds += duration;
    if (i >= steps - resting) resting_seconds += duration;
    if (i % 10 != 0) continue;
    for (const Contact& contact :
         simulation.contact()->finder().find(simulation.state(), simulation.time(), 0))
      cost.deepest = std::max(cost.deepest, -contact.gap / kBodySize);
  }
  cost.step = seconds * 1e6 / cost.bodies / steps;
  cost.resting_step = resting_seconds * 1e6 / cost.bodies / resting;
  cost.residual = simulation.step_counters().contact_residual;
  cost.fallbacks = simulation.step_counters().contact_fallbacks;
  return seconds;
}

/// Returns the processor time of a call in microseconds per body.
template <class Act>
double time_of(const Cost& cost, Act&& act) {
  return bench::seconds_per_call<bench::ProcessorClock>(act, 0.01, 5) * 1e6 / cost.bodies;
}

double time_of_step(const Cost& cost, Simulation& simulation, const State& from) {
  return time_of(cost, [&] {
    simulation.set_state(from);
    simulation.step(kStep);
  });
}

/// Measures the stages of a step that starts in a state.
void measure_stages(Simulation& simulation, const State& state, Cost& cost) {
  const ContactFinder& finder = simulation.contact()->finder();
  const double t = state.time();
  cost.near = time_of(cost, [&] { finder.neighbourhood(state, t, kStep); });
  const std::vector<Contact> contacts = finder.find(state, t, 1e-6);
  cost.contacts = static_cast<int>(contacts.size());
  cost.find = time_of(cost, [&] { finder.find(state, t, 1e-6); });
  Workspace<double> work;
  simulation.dynamics().accelerations(t, state.q, state.v, state, work);
  std::vector<int> all;
  for (int i = 0; i < cost.bodies; ++i) all.push_back(i);
  State after = state;
  after.v += kStep * work.v_dot;
  simulation.dynamics().evaluate_masses(after.time(), after.q, after.v, all, work);
  cost.solve = time_of(cost, [&] {
    ContactProblem problem(simulation.model(), after, work, contacts);
    problem.solve(1);
  });
}

/// Measures a system of n bodies. tolerance: ContactSettings::tolerance; 0: contact has no tolerance.
/// seconds: receives the processor time of the run, s.
Cost measure(const System& system, int n, double tolerance, double& seconds) {
  MultiBody body, without_contact, sleepy;
  for (MultiBody* each : {&body, &without_contact, &sleepy}) {
    bench::build(*each, system, n);
    if (tolerance > 0) each->contact.tolerance = tolerance;
  }
  without_contact.contact.active = false;
  sleepy.contact.sleep = Sleep{1e-3};
  Simulation simulation(body, "rk4"), contact_free(without_contact, "rk4"), sleeping(sleepy, "rk4");
  Cost cost;
  cost.system = system.name;
  cost.bodies = n;
  seconds = measure_run(simulation, cost);
  State state = simulation.state();
  state.contact_cache_age = 0;
  State without_cache = state, asleep = state;
  without_cache.contact_cache.clear();
  asleep.v.setZero();
  asleep.at_rest.assign(static_cast<std::size_t>(n), -1);
  cost.warm = time_of_step(cost, simulation, state);
  cost.cold = time_of_step(cost, simulation, without_cache);
  cost.motion = time_of_step(cost, contact_free, state);
  cost.asleep = time_of_step(cost, sleeping, asleep);
  measure_stages(simulation, state, cost);
  return cost;
}

void print(const Cost& c, bench::TableFile& file) {
  std::printf("%-45s %6d %8d | %8.3f %8.3f %8.3f %8.3f %8.3f | %8.3f %8.3f %8.3f %8.3f | %8.1e %8.1e %ld\n",
              c.system.c_str(), c.bodies, c.contacts, c.step, c.resting_step, c.warm, c.cold, c.asleep,
              c.motion, c.near, c.find, c.solve, c.deepest, c.residual, c.fallbacks);
  std::fflush(stdout);
  file.row("\"%s\",%d,%d,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3e,%.3e,%ld\n", c.system.c_str(),
           c.bodies, c.contacts, c.step, c.resting_step, c.warm, c.cold, c.asleep, c.motion, c.near, c.find,
           c.solve, c.deepest, c.residual, c.fallbacks);
}

/// The largest number of bodies, the largest time of a run (s), and the tolerance of contact.
struct Extent {
  int max_bodies;
  double max_seconds, tolerance;
};

/// Measures a system with 10, 100, ... bodies and prints its costs and their growth.
void measure_sizes(const System& system, const Extent& extent, bench::TableFile& costs_file,
                   bench::TableFile& exponents_file) {
  std::vector<Cost> costs;
  double seconds = 0;
  try {
    for (int n = 10; n <= extent.max_bodies && 11 * seconds < extent.max_seconds; n *= 10) {
      costs.push_back(measure(system, n, extent.tolerance, seconds));
      print(costs.back(), costs_file);
    }
  } catch (const StepFailure& failure) {
    std::printf("%-45s failed: %s\n", system.name.c_str(), failure.what());
  }
  if (costs.size() < 2) return;
  const double moving = bench::exponent(costs, &Cost::bodies, &Cost::step),
               resting = bench::exponent(costs, &Cost::bodies, &Cost::resting_step);
  std::printf("%-45s total time grows as the number of bodies to the power %.3f (step), %.3f (at rest)\n",
              system.name.c_str(), moving, resting);
  exponents_file.row("\"%s\",%.4f,%.4f\n", system.name.c_str(), moving, resting);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string folder = argc > 1 ? std::string(argv[1]) + "/" : "", only = argc > 3 ? argv[3] : "";
  const Extent extent{argc > 2 ? std::atoi(argv[2]) : 10000, argc > 4 ? std::atof(argv[4]) : 60,
                      argc > 5 ? std::atof(argv[5]) : 0};
  auto in_folder = [&](const char* name) { return folder.empty() ? std::string() : folder + name; };
  char calibration[128];
  std::snprintf(calibration, sizeof calibration, "# multiply-adds per second %.3g, triad %.3g bytes/s\n",
                bench::multiply_add_peak(), bench::triad_bandwidth());
  std::printf("%s", calibration);
  bench::TableFile costs_file(in_folder("contact_bench.csv"),
                              std::string(calibration) +
                                  "system,bodies,contacts,step_us_per_body,still_step_us_per_body,begun_us,"
                                  "anew_us,asleep_us,motion_us,"
                                  "near_us,find_us,solve_us,deepest_in_sizes,residual,fallbacks\n");
  bench::TableFile exponents_file(in_folder("contact_exponents.csv"),
                                  std::string(calibration) + "system,step,still_step\n");
  std::printf(
      "microseconds per body and step\n%-45s %6s %8s | %8s %8s %8s %8s %8s | %8s %8s %8s %8s | %8s %8s %s\n",
      "system", "bodies", "contacts", "step", "at rest", "warm", "cold", "asleep", "motion", "near", "find",
      "solve", "deepest", "residual", "fallbacks");
  for (const System& system : bench::systems())
    if (system.name.find(only) != std::string::npos)
      measure_sizes(system, extent, costs_file, exponents_file);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
