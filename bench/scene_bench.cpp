// Run time against energy error of scenes, with every method of integration. The step is 0.02 s at first, and
// is halved up to six times, until the energy error is below 1e-10 of the largest kinetic energy. If the
// argument is a folder of scenes, the program measures the mechanisms A01, A02 and A04 of the IFToMM
// benchmark library (Gonzalez et al. 2006).
//
//   scene_bench [--end SECONDS] [-o FILE.csv] SCENES_FOLDER | SCENE.json ...
//
// The time is the CPU time of the stepping loop, with one thread. The errors are sampled at a hundred times.
// The energy error is the largest error of the energy balance (Ledger::balance), and the gap is the widest
// gap of the closed joints.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <pliant/io/run/joint_notes.h>
#include <pliant/pliant.h>
#include <pliant/scene/read_scene.h>

#include "table_file.h"

using namespace pliant;

namespace {

constexpr double kFirstStep = 0.02,  // s
    kMinError = 1e-10;               // energy error / kinetic energy
constexpr int kHalvings = 6, kSamples = 100;

struct Run {
  double cpu_ms = 0, error = 0, kinetic = 0, gap = 0;  ///< ms, J, J, m
};

Run run(const std::string& file, const char* method, double end, long steps) {
  Diagnostics problems;
  const auto scene = read_scene(file, {}, problems);
  Run result;
  Simulation simulation(scene->body, method);
  const double h = end / static_cast<double>(steps);
  for (int sample = 0; sample < kSamples; ++sample) {
    const std::clock_t start = std::clock();
    for (long i = steps * sample / kSamples; i < steps * (sample + 1) / kSamples; ++i) simulation.step(h);
    result.cpu_ms += 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const Ledger ledger = simulation.ledger();
    result.error = std::max(result.error, std::abs(ledger.balance));
    result.kinetic = std::max(result.kinetic, ledger.kinetic);
    result.gap = std::max(result.gap, widest_gaps(simulation).closed);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  double end = 10;
  std::string csv;
  std::vector<std::string> scenes;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--end") == 0 && i + 1 < argc)
      end = std::atof(argv[++i]);
    else if (std::strcmp(argv[i], "-o") == 0 && i + 1 < argc)
      csv = argv[++i];
    else if (std::filesystem::is_directory(argv[i]))
      for (const char* name : {"point_pendulum", "n_four_bar", "bricard"})
        scenes.push_back(std::string(argv[i]) + "/" + name + ".json");
    else
      scenes.push_back(argv[i]);
  }
  if (scenes.empty() || !(end > 0)) {
    std::fprintf(stderr, "usage: scene_bench [--end SECONDS] [-o FILE.csv] SCENES_FOLDER | SCENE.json ...\n");
    return 2;
  }
  bench::TableFile file(csv, "scene,method,end_s,step_s,cpu_ms,energy_error_J,largest_kinetic_J,gap_m\n");
  for (const std::string& scene : scenes) {
    const std::string name = std::filesystem::path(scene).stem().string();
    for (const IntegratorInfo& method : all_integrators()) {
      double previous_error = std::nan("");
      for (int halving = 0; halving <= kHalvings; ++halving) {
        const long steps = std::max(1L, std::lround(end / kFirstStep)) << halving;
        const double h = end / static_cast<double>(steps);
        try {
          const Run result = run(scene, method.name, end, steps);
          std::printf("%-16s %-20s h %9.3g s  %9.2f ms  energy %8.1e of %.1e J  order %5.2f  gap %.1e m\n",
                      name.c_str(), method.name, h, result.cpu_ms, result.error, result.kinetic,
                      std::log2(previous_error / result.error), result.gap);
          file.row("%s,%s,%g,%g,%.3f,%.3e,%.3e,%.3e\n", name.c_str(), method.name, end, h, result.cpu_ms,
                   result.error, result.kinetic, result.gap);
          previous_error = result.error;
          if (result.error < kMinError * result.kinetic) break;
        } catch (const StepFailure& failure) {
          std::printf("%-16s %-20s h %9.3g s  %s\n", name.c_str(), method.name, h, failure.what());
          file.row("%s,%s,%g,%g,nan,nan,nan,nan\n", name.c_str(), method.name, end, h);
        }
      }
    }
  }
} catch (const std::exception& failure) {
  std::fprintf(stderr, "scene_bench: %s\n", failure.what());
  return 1;
}
