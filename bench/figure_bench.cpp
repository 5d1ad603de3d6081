// Measures the scenes of the paper's figures on one core: the real-time factor (simulated time / clock time),
// the shares of the stages in the run time, and the largest depth of a contact / size of the smaller body,
// sampled 60 times per simulated second. Writes CSV to standard output.
//
//   figure_bench SCENES_FOLDER [FOLDER]     writes figure_bench.csv to FOLDER as well
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>

#include <pliant/contact/contact_stepping.h>
#include <pliant/io/run/contact_notes.h>
#include <pliant/pliant.h>
#include <pliant/scene/read_scene.h>
#ifdef PLIANT_HAS_SUITESPARSE
#include <pliant/solve/suitesparse.h>
#endif

#include "table_file.h"
#include "timing.h"

using namespace pliant;
using StageTimes = ContactStepping::StageTimes;

namespace {

/// Simulates a scene and returns its row of the table.
std::string measure(const std::string& folder, const std::string& name) {
  using Clock = std::chrono::steady_clock;
  auto seconds = [](Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
  };
  JointSolver solver;
#ifdef PLIANT_HAS_SUITESPARSE
  use_suitesparse(solver);
#endif
  Diagnostics problems;
  const auto before = Clock::now();
  const auto scene = read_scene(folder + "/" + name + ".json", {}, problems, solver);
  Simulation simulation(scene->body, scene->integrator);
  const double load = seconds(before);
  const auto steps = static_cast<long>(scene->end / scene->step + 0.5);
  const auto steps_per_sample = std::max(1L, static_cast<long>(1 / (60 * scene->step)));
  double run_time = 0, deepest = 0;
  for (long i = 0; i < steps;) {
    const auto start = Clock::now();
    for (const long next = std::min(steps, i + steps_per_sample); i < next; ++i) simulation.step(scene->step);
    run_time += seconds(start);
    deepest = std::max(deepest, deepest_share(simulation));
  }
  const ContactStepping* contact = simulation.contact();
  const ContactStepping::StageTimes stages =
      contact != nullptr ? contact->times() : StageTimes{run_time, 0, 0};
  char line[256];
  std::snprintf(line, sizeof line, "%s,%d,%.3g,%.3g,%.2f,%.2f,%.2f,%.1f,%.1f,%.1f,%.1e\n", name.c_str(),
                simulation.model().n_v(), scene->end, scene->step, load, run_time,
                simulation.time() / run_time, 100 * stages.motion / run_time, 100 * stages.finding / run_time,
                100 * stages.resolution / run_time, deepest);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: figure_bench SCENES_FOLDER [FOLDER]\n");
    return 2;
  }
  try {
    char calibration[64];
    std::snprintf(calibration, sizeof calibration, "# multiply-adds per second %.3g\n",
                  bench::multiply_add_peak());
    const std::string head =
        std::string(calibration) +
        "scene,velocities,seconds,step_s,load_s,taken_s,real_time_factor,motion_percent,finding_percent,"
        "resolution_percent,deepest_share\n";
    bench::TableFile file(argc > 2 ? std::string(argv[2]) + "/figure_bench.csv" : "", head);
    std::fputs(head.c_str(), stdout);
    for (const char* name :
         {"pull", "soft_pull", "gallery", "balloons", "dragonfly", "snowman", "springboard"}) {
      const std::string row = measure(argv[1], name);
      std::fputs(row.c_str(), stdout);
      std::fflush(stdout);
      file.row("%s", row.c_str());
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "figure_bench: %s\n", e.what());
    return 1;
  }
}
