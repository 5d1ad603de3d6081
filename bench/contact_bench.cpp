// The cost of contact: time per body and step. The systems are solids that fall onto a plane, from the first
// impacts until they are at rest, alone or as a heap of five layers, and standing towers and pyramids of ten
// boxes. The solids are ellipsoids, and in up to a hundred bodies every other shape, deformed ones included.
// The program also measures the exponent with which the cost grows with the number of bodies, and the time of
// each stage.
//
//   contact_bench [FOLDER] [MAX] [NAME]
//
// Writes contact_bench.csv and contact_exponents.csv to FOLDER and a table to standard output. MAX: the
// largest number of bodies (10000). NAME: measures only the systems whose name contains this text.
//
// Columns of the table, with the names of the columns of the files if they differ:
//   step               mean time of a step in the whole run (step_us_per_body)
//   at rest            mean time of a step in the last tenth of the run (still_step_us_per_body)
//   warm               a step at the end that is warm-started from the contact cache (begun_us)
//   cold               a step at the end without the cache (anew_us); in a run, the step after ten warm ones
//   asleep             a step at the end in which all bodies sleep, an option of scenes
//   motion             stage of a step at the end: the method of integration without contact
//   near, find, solve  stages of a step at the end: candidate pairs, contacts, impulses
//   deepest            largest depth of a contact in the run / 0.1 m (deepest_in_sizes)
//   residual           largest residual of a contact solution, m/s
//   fallbacks          clusters of contacts without a solution, see step_counters.h
//
// The stages are timed one by one in separate loops, so that the processor caches contain their data.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <pliant/contact/contact_stepping.h>
#include <pliant/pliant.h>

#include "exponent.h"
#include "table_file.h"
#include "timing.h"

using namespace pliant;

namespace {

constexpr double kStep = 2e-3, kDuration = 1;

enum class Bodies { rigid, soft, towers, pyramids };  ///< soft: three parameters per body

/// A kind of solid: shape, chain of deformations, and rest values for three numbers between 0 and 1.
struct Kind {
  const char *name, *shape;
  std::vector<std::string> chain;
  Part::Named (*rest)(double a, double b, double c);
  int max_heap = 100;  ///< largest number of bodies in a heap; less for pairs that need a numerical search
};
Part::Named axes(double a, double b, double c) {
  return {{"a1", 0.06 + 0.04 * a}, {"a2", 0.06 + 0.04 * b}, {"a3", 0.06 + 0.04 * c}};
}
template <int eps1, int eps2>  // in tenths
Part::Named superquadric(double a, double b, double c) {
  Part::Named rest = axes(a, b, c);
  rest.push_back({"eps1", 0.1 * eps1});
  rest.push_back({"eps2", 0.1 * eps2});
  return rest;
}
Part::Named with(Part::Named rest, const char* name, double value) {
  rest.push_back({name, value});
  return rest;
}
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"ellipsoid", "ellipsoid", {}, axes},
      {"box", "box", {}, axes},
      {"cylinder", "cylinder", {}, axes},
      {"cone", "cone", {}, [](double a, double b, double c) { return with(axes(a, b, c), "t", -0.5); }},
      {"capsule",
       "capsule",
       {},
       [](double a, double, double c) {
         return Part::Named{{"r", 0.04 + 0.02 * a}, {"l", 0.06 + 0.04 * c}};
       }},
      {"superellipsoid, 1", "superellipsoid", {}, superquadric<10, 10>},
      {"superellipsoid, 0.5", "superellipsoid", {}, superquadric<5, 5>},
      {"superellipsoid, 0.1", "superellipsoid", {}, superquadric<1, 1>},
      {"superellipsoid, 1.5", "superellipsoid", {}, superquadric<15, 15>},
      {"sheared cylinder",
       "cylinder",
       {"shear"},
       [](double a, double b, double c) { return with(axes(a, b, c), "shear.sx", 0.3); }},
      {"supertoroid",
       "supertoroid",
       {},
       [](double a, double, double c) {
         const double tube = 0.02 + 0.01 * a;
         return Part::Named{{"a1", tube}, {"a2", tube}, {"a3", 0.02 + 0.01 * c}, {"a4", 3}};
       },
       10},
      {"tapered ellipsoid",
       "ellipsoid",
       {"taper"},
       [](double a, double b, double c) { return with(axes(a, b, c), "taper.tx", -0.3); },
       10},
      {"twisted box",
       "box",
       {"twist"},
       [](double a, double b, double c) { return with(axes(a, b, c), "twist.angle", 0.5); },
       10},
      {"bent capsule",
       "capsule",
       {"bend"},
       [](double a, double, double c) {
         return Part::Named{{"r", 0.04 + 0.02 * a}, {"l", 0.06 + 0.04 * c}, {"bend.angle", 0.5}};
       },
       10}};
  return all;
}

struct System {
  std::string name;
  Bodies bodies;
  int layers;                  ///< number of layers on top of each other; not used for pyramids
  int max_bodies;              ///< largest number of bodies
  const Kind* kind = nullptr;  ///< the solids that fall; not used for towers and pyramids
};

/// A row of the table. Times are in microseconds per body and step.
struct Cost {
  std::string system;
  int bodies, contacts;
  double warm, cold;
  double step, resting_step;  ///< means over the whole run, and over its last tenth
  double asleep;              ///< a step in which all bodies sleep
  double motion, near, find, solve;
  double deepest;   ///< largest depth of a contact in the run / 0.1 m, which is about the size of a body
  double residual;  ///< m/s
  long fallbacks;
};

/// Returns the fractional part of (i + 1) * ratio: a quasi-random number in [0, 1).
double spread(int i, double ratio) {
  return std::fmod((i + 1) * ratio, 1.0);
}

void build_towers(MultiBody& body, const System& system, int n) {
  constexpr double half = 0.05;
  const int across = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(n) / system.layers)));
  for (int i = 0; i < n; ++i) {
    const int tower = i / system.layers, layer = i % system.layers;
    Part& part = body.add(make_part("body" + std::to_string(i), "box", {}, 1000));
    part.rest({{"a1", half}, {"a2", half}, {"a3", half}});
    part.place({0.25 * (tower % across), 0.25 * (tower / across), (1 + 2 * layer) * half});
  }
}

/// Adds pyramids with rows of 4, 3, 2 and 1 boxes.
void build_pyramids(MultiBody& body, int n) {
  constexpr double half = 0.05;
  for (int first = 0; first < n; first += 10)
    for (int row = 0, i = first; row < 4; ++row)
      for (int k = 0; k < 4 - row; ++k, ++i) {
        Part& part = body.add(make_part("body" + std::to_string(i), "box", {}, 1000));
        part.rest({{"a1", half}, {"a2", half}, {"a3", half}});
        part.place({half * (2.1 * k + 1.05 * row), 0.025 * first, (1 + 2 * row) * half});
      }
}

void build_solids(MultiBody& body, const System& system, int n) {
  const int across = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(n) / system.layers)));
  for (int i = 0; i < n; ++i) {
    const double a = spread(i, 0.6180339887498949), b = spread(i, 0.7548776662466927),
                 c = spread(i, 0.5698402909980532);
    const Kind& kind = *system.kind;
    Part& part = body.add(make_part("body" + std::to_string(i), kind.shape, kind.chain, 1000));
    part.rest(kind.rest(a, b, c));
    const int layer = i / (across * across), place = i % (across * across);
    const Vec3<double> axis = Vec3<double>(a - 0.5, b - 0.5, c - 0.4).normalized();
    // Corners and rims reach farther than the axes; the solids start apart from each other.
    const bool is_round = &kind == &kinds().front();
    const double apart = is_round ? 0.25 : 0.45, above = is_round ? 0.35 : 0.45;
    part.place({apart * (place % across) + 0.02 * a, apart * (place / across) + 0.02 * b,
                0.15 + 0.1 * c + above * layer},
               Eigen::Quaterniond(Eigen::AngleAxisd(6 * a, axis)));
    if (system.bodies == Bodies::soft)
      part.stiffness({{"a1", 3e4}, {"a2", 3e4}, {"a3", 3e4}}).damping(0, 2e-3);
  }
}

void build(MultiBody& body, const System& system, int n) {
  if (system.bodies == Bodies::pyramids)
    build_pyramids(body, n);
  else
    (system.bodies == Bodies::towers ? build_towers : build_solids)(body, system, n);
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}

Cost measure(const System& system, int n) {
  MultiBody body, without_contact, sleepy;
  for (MultiBody* each : {&body, &without_contact, &sleepy}) build(*each, system, n);
  without_contact.contact.active = false;
  sleepy.contact.sleep = Sleep{1e-3};
  Simulation simulation(body, "rk4"), contact_free(without_contact, "rk4"), sleeping(sleepy, "rk4");
  Cost cost{};
  cost.system = system.name;
  cost.bodies = n;
  const int steps = static_cast<int>(std::lround(kDuration / kStep)), resting = steps / 10;
  const ContactFinder& finder = simulation.contact()->finder();
  auto per_body = [&](double seconds, int count) { return seconds * 1e6 / n / count; };
  double seconds = 0;
  for (int i = 0; i < steps; ++i) {
    const auto start = bench::ProcessorClock::now();
    simulation.step(kStep);
    const double duration = std::chrono::duration<double>(bench::ProcessorClock::now() - start).count();
    seconds += duration;
    if (i >= steps - resting) cost.resting_step += per_body(duration, resting);
    if (i % 10 != 0) continue;
    for (const Contact& contact : finder.find(simulation.state(), simulation.time(), 0))
      cost.deepest = std::max(cost.deepest, -contact.gap / 0.1);
  }
  cost.step = per_body(seconds, steps);
  cost.residual = simulation.step_counters().contact_residual;
  cost.fallbacks = simulation.step_counters().contact_fallbacks;
  State state = simulation.state();
  state.contact_cache_age = 0;
  const double t = state.time();
  auto stage = [&](auto&& act) {
    return per_body(bench::seconds_per_call<bench::ProcessorClock>(act, 0.01, 5), 1);
  };
  State without_cache = state;
  without_cache.contact_cache.clear();
  auto step_from = [&](const State& from) {
    return stage([&] {
      simulation.set_state(from);
      simulation.step(kStep);
    });
  };
  cost.warm = step_from(state);
  cost.cold = step_from(without_cache);
  contact_free.set_state(state);
  cost.motion = stage([&] {
    contact_free.set_state(state);
    contact_free.step(kStep);
  });
  State asleep = state;
  asleep.v.setZero();
  asleep.at_rest.assign(static_cast<std::size_t>(n), -1);
  cost.asleep = stage([&] {
    sleeping.set_state(asleep);
    sleeping.step(kStep);
  });
  cost.near = stage([&] { finder.neighbourhood(state, t, kStep); });
  const std::vector<Contact> contacts = finder.find(state, t, 1e-6);
  cost.contacts = static_cast<int>(contacts.size());
  cost.find = stage([&] { finder.find(state, t, 1e-6); });
  Workspace<double> work;
  simulation.dynamics().accelerations(t, state.q, state.v, state, work);
  std::vector<int> all;
  for (int i = 0; i < n; ++i) all.push_back(i);
  State falling = state;
  for (const PartModel& m : simulation.model().parts()) falling.v.segment<3>(m.v0) += kStep * body.gravity;
  simulation.dynamics().evaluate_masses(falling.q, falling.v, all, work);
  cost.solve = stage([&] {
    ContactProblem problem(simulation.model(), falling, work, contacts);
    problem.solve(1);
  });
  return cost;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string folder = argc > 1 ? std::string(argv[1]) + "/" : "";
  const int max_bodies = argc > 2 ? std::atoi(argv[2]) : 10000;
  const std::string only = argc > 3 ? argv[3] : "";
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
  const Kind& ellipsoid = kinds().front();
  std::vector<System> systems{{"rigid", Bodies::rigid, 1, 10000, &ellipsoid},
                              {"3 parameters", Bodies::soft, 1, 10000, &ellipsoid},
                              {"rigid, heap", Bodies::rigid, 5, 1000, &ellipsoid},
                              {"towers of ten", Bodies::towers, 10, 1000},
                              {"pyramids of ten", Bodies::pyramids, 10, 1000}};
  for (const Kind& kind : kinds())
    systems.push_back({std::string(kind.name) + ", plane", Bodies::rigid, 1, 100, &kind});
  for (const Kind& kind : kinds())
    systems.push_back({std::string(kind.name) + ", heap", Bodies::rigid, 5, kind.max_heap, &kind});
  std::printf(
      "microseconds per body and step\n%-27s %6s %8s | %8s %8s %8s %8s %8s | %8s %8s %8s %8s | %8s %8s %s\n",
      "system", "bodies", "contacts", "step", "at rest", "warm", "cold", "asleep", "motion", "near", "find",
      "solve", "deepest", "residual", "fallbacks");
  for (const System& system : systems) {
    if (system.name.find(only) == std::string::npos) continue;
    std::vector<Cost> costs;
    for (int n = 10; n <= std::min(max_bodies, system.max_bodies); n *= 10) {
      const Cost c = measure(system, n);
      costs.push_back(c);
      std::printf(
          "%-27s %6d %8d | %8.3f %8.3f %8.3f %8.3f %8.3f | %8.3f %8.3f %8.3f %8.3f | %8.1e %8.1e %ld\n",
          c.system.c_str(), c.bodies, c.contacts, c.step, c.resting_step, c.warm, c.cold, c.asleep, c.motion,
          c.near, c.find, c.solve, c.deepest, c.residual, c.fallbacks);
      std::fflush(stdout);
      costs_file.row("\"%s\",%d,%d,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3e,%.3e,%ld\n",
                     c.system.c_str(), c.bodies, c.contacts, c.step, c.resting_step, c.warm, c.cold, c.asleep,
                     c.motion, c.near, c.find, c.solve, c.deepest, c.residual, c.fallbacks);
    }
    if (costs.size() < 2) continue;
    const double moving = bench::exponent(costs, &Cost::bodies, &Cost::step),
                 resting = bench::exponent(costs, &Cost::bodies, &Cost::resting_step);
    std::printf("%-27s total time grows as the number of bodies to the power %.3f (step), %.3f (at rest)\n",
                system.name.c_str(), moving, resting);
    exponents_file.row("\"%s\",%.4f,%.4f\n", system.name.c_str(), moving, resting);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
