// Run time of soft contact as a function of the number of triangles of each balloon. The systems are a
// balloon that falls onto a plane, and nine balloons on strings that collide.
//
//   balloon_bench [FOLDER] [MAX]   writes balloon_bench.csv to FOLDER and a table to standard output; MAX:
//   the largest number of triangles of a balloon (default: 5120)
//
// The balloon has a radius of 0.1 m and consists of 1 mm of rubber with E = 1e7 Pa. It falls from a height of
// half its radius; the run ends after 0.5 s. The nine balloons are equal to this balloon, or have 0.5 mm of
// rubber with E = 1e5 Pa and a pressure of 30 Pa. Their runs end after 1 s.
// The real-time factor is simulated time / processor time, with one thread.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <pliant/body/joints/string.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/pliant.h>

#include "table_file.h"
#include "timing.h"

using namespace pliant;

namespace {

constexpr double kRadius = 0.1, kDensity = 1000, kShare = 0.7,  // m, kg/m^3, step / largest stable step
    kMaxStep = 1e-3;                                            // s

/// beta: damping proportional to the stiffness. drag: damping of all motion of the balloons.
struct System {
  const char* name;
  double E, thickness, pressure, beta, drag, duration;  ///< Pa, m, Pa, s, 1/s, s
  const char* method;
};

Part& balloon(MultiBody& body, const System& system, const std::string& name, int resolution,
              const Vec3<double>& centre) {
  auto& part = body.add<Primitive<Ellipsoid>>(name, kDensity * system.thickness);
  part.make_shell().rest({{"a1", kRadius}, {"a2", kRadius}, {"a3", kRadius}}).place(centre);
  LocalSettings settings;
  settings.resolution = resolution;
  settings.alpha = 1;
  settings.beta = system.beta;
  settings.energies.push_back(local_law("neo_hookean_membrane", {system.E, 0.45, system.thickness}));
  settings.energies.push_back(local_law("pressure", {system.pressure}));
  part.deform_locally(settings);
  part.damping(0, 0, system.drag);
  return part;
}

void drop(MultiBody& body, const System& system, int resolution) {
  balloon(body, system, "balloon", resolution, {0, 0, 1.5 * kRadius});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
/// Adds 3 x 3 balloons on strings. At the start, the outer balloons are pulled away from the middle one.
void suspend(MultiBody& body, const System& system, int resolution) {
  constexpr double length = 1;
  body.contact.active = true;
  for (int i = 0; i < 9; ++i) {
    const double x = 0.22 * (i % 3 - 1), y = 0.22 * (i / 3 - 1);
    const double angle = std::hypot(x, y) > 0 ? 0.5 : 0;
    const Vec3<double> outward = angle > 0 ? Vec3<double>(x, y, 0).normalized() : Vec3<double>(1, 0, 0);
    const Vec3<double> hook(x, y, 0), down = std::sin(angle) * outward - Vec3<double>(0, 0, std::cos(angle));
    const std::string name = "balloon" + std::to_string(i + 1);
    Part& part = balloon(body, system, name, resolution, hook + (length + kRadius) * down);
    part.place(hook + (length + kRadius) * down,
               Eigen::Quaterniond::FromTwoVectors(Vec3<double>(0, 0, -1), down));
    body.join("string" + std::to_string(i + 1), String{length},
              {world(hook[0], hook[1], hook[2]), point(part, kPi / 2, 0)});
  }
}

/// Returns the largest depth of a contact between two parts, or between a part and the plane, m.
double deepest(const Simulation& simulation, const MeshFinder& finder) {
  std::vector<Contact> found;
  finder.find(simulation.state(), simulation.time(), found);
  double max_overlap = 0;
  for (const Contact& contact : found) max_overlap = std::max(max_overlap, -contact.gap);
  return max_overlap;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string folder = argc > 1 ? std::string(argv[1]) + "/" : "";
  const int max_triangles = argc > 2 ? std::atoi(argv[2]) : 5120;
  char calibration[128];
  std::snprintf(calibration, sizeof calibration, "# multiply-adds per second %.3g, triad %.3g bytes/s\n",
                bench::multiply_add_peak(), bench::triad_bandwidth());
  std::printf("%s%-22s %9s %9s %6s | %8s %8s %8s | %9s %9s %9s\n", calibration, "system", "triangles", "step",
              "steps", "free", "contact", "factor", "deepest", "string", "residual");
  bench::TableFile file(
      folder.empty() ? "" : folder + "balloon_bench.csv",
      std::string(calibration) +
          "system,method,triangles,step_s,simulated_s,free_step_ms,step_ms,real_time_factor,"
          "deepest_m,string_error_m,contact_residual_m_s,balance_share\n");
  const std::vector<System> systems{
      {"drop", 1e7, 1e-3, 0, 0, 0, 0.5, "semi_implicit_euler"},
      {"nine on strings", 1e5, 5e-4, 30, 3e-4, 0.25, 1, "semi_implicit_euler"},
      {"nine firm ones on strings", 1e7, 1e-3, 0, 0, 0, 1, "semi_implicit_euler"}};
  for (const System& system : systems) {
    const bool nine = system.duration == 1;
    for (const int resolution : {3, 5, 10}) {
      MultiBody body, without_contact;
      for (MultiBody* each : {&body, &without_contact}) (nine ? suspend : drop)(*each, system, resolution);
      without_contact.contact.active = false;
      Simulation simulation(body, system.method), contact_free(without_contact, system.method);
      const int triangles =
          static_cast<int>(surface_nodes(simulation.model().parts()[0].local->mesh()).triangles.cols());
      if (triangles > max_triangles || (nine && resolution > 3)) continue;
      const MeshFinder finder(simulation.model(), simulation.contact()->finder().obstacles());
      const double h = std::min(kMaxStep, kShare * largest_stable_step(simulation));
      const auto steps = static_cast<int>(std::ceil(system.duration / h));
      double seconds = 0, max_overlap = 0, max_stretch = 0;
      for (int i = 0; i < steps; ++i) {
        const auto start = bench::ProcessorClock::now();
        simulation.step(h);
        seconds += std::chrono::duration<double>(bench::ProcessorClock::now() - start).count();
        if (i % 10 != 0) continue;
        max_overlap = std::max(max_overlap, deepest(simulation, finder));
        for (int j = 0; j < static_cast<int>(simulation.model().joints().size()); ++j)
          max_stretch = std::max(max_stretch, simulation.model().gap(simulation.state(), j));
      }
      const double free_step =
          bench::seconds_per_call<bench::ProcessorClock>([&] { contact_free.step(h); }, 0.02, 3);
      const double factor = simulation.time() / seconds, step = seconds / steps;
      const Ledger ledger = simulation.ledger();
      std::printf("%-22s %9d %9.2e %6d | %8.4f %8.4f %8.3f | %9.1e %9.1e %9.1e\n", system.name, triangles, h,
                  steps, 1e3 * free_step, 1e3 * step, factor, max_overlap, max_stretch,
                  simulation.step_counters().contact_residual);
      std::fflush(stdout);
      file.row("%s,%s,%d,%.4g,%.4g,%.5f,%.5f,%.4f,%.3e,%.3e,%.3e,%.3e\n", system.name, system.method,
               triangles, h, simulation.time(), 1e3 * free_step, 1e3 * step, factor, max_overlap, max_stretch,
               simulation.step_counters().contact_residual,
               std::abs(ledger.balance) / std::abs(ledger.work.sum()));
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
