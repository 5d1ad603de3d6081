// Simulates a scene and records the states of its rigid parts at equal intervals, for the comparison with
// other engines in bench/peers.
//
//   scene_states SCENE.json METHOD step|tolerance VALUE INTERVAL FILE
//
// VALUE: length of the steps in s, or the tolerance. INTERVAL: time between two states in s; a step ends at
// each of these times. The run ends at the end time of the scene. Writes 13 numbers for each part and time to
// FILE (doubles, without a header): centre, quaternion w x y z, velocity (world), angular velocity (body
// frame). Prints the CPU time of the steps in seconds, without the time of loading and recording.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>

#include <pliant/pliant.h>
#include <pliant/scene/read_scene.h>

#include "timing.h"

using namespace pliant;

namespace {

struct Options {
  std::string scene, method, file;
  double step = 0, tolerance = 0, interval = 0;  ///< step and interval in s; one of step and tolerance is 0
};

void record(const Simulation& simulation, std::ofstream& file) {
  const State& state = simulation.state();
  for (const PartModel& part : simulation.model().parts()) {
    Eigen::Matrix<double, 13, 1> numbers;
    numbers << state.q.segment<7>(part.q0), state.v.segment<6>(part.v0);
    file.write(reinterpret_cast<const char*>(numbers.data()), sizeof(double) * 13);
  }
}

/// Returns the CPU time of the steps, s.
double simulate(const Options& options) {
  Diagnostics problems;
  const auto scene = read_scene(options.scene, {}, problems);
  Simulation simulation(scene->body, options.method, 1, options.tolerance);
  std::ofstream file(options.file, std::ios::binary);
  const long intervals = std::lround(scene->end / options.interval),
             steps = options.tolerance > 0 ? 1 : std::lround(options.interval / options.step);
  double seconds = 0;
  record(simulation, file);
  for (long i = 0; i < intervals; ++i) {
    const auto start = bench::ProcessorClock::now();
    for (long k = 0; k < steps; ++k) simulation.step(options.interval / static_cast<double>(steps));
    seconds += std::chrono::duration<double>(bench::ProcessorClock::now() - start).count();
    record(simulation, file);
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + options.file);
  return seconds;
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  if (argc != 7) {
    std::fprintf(stderr, "usage: scene_states SCENE.json METHOD step|tolerance VALUE INTERVAL FILE\n");
    return 2;
  }
  options.scene = argv[1];
  options.method = argv[2];
  (std::strcmp(argv[3], "step") == 0 ? options.step : options.tolerance) = std::atof(argv[4]);
  options.interval = std::atof(argv[5]);
  options.file = argv[6];
  std::printf("%.9g\n", simulate(options));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
