// Time per triangle of four calls for a spinning sphere with a linear membrane: the force kernel of the
// membrane, an evaluation of the accelerations, a step of RK4 (four evaluations) and a step of semi-implicit
// Euler (one evaluation), at half the largest stable step of the method. Each time is the minimum of four
// rounds. The last column is the time per evaluation / time of the kernel. Writes CSV to standard output.
//
//   soft_step_bench [FOLDER]     also writes soft_step_bench.csv to FOLDER
#include <algorithm>
#include <cstdio>
#include <exception>
#include <limits>
#include <string>

#include <pliant/part/local/local_laws.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/pliant.h>

#include "table_file.h"
#include "timing.h"

using namespace pliant;

namespace {

void measure(int resolution, int threads, bench::TableFile& file) {
  MultiBody body;
  body.gravity.setZero();  // with gravity the speed would reach hundreds of m/s in the many steps
  auto& part = body.add<Primitive<Sphere>>("balloon", 1.0);
  part.make_shell().velocity({0, 0, 0}, {0.1, 0.2, 0.3});
  LocalSettings settings;
  settings.resolution = resolution;
  settings.energies = {local_law("membrane", {1e5, 0.3, 0.01})};
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return {1e-3 * X[1] * X[2], 0, 0}; };
  part.deform_locally(settings);
  Simulation rk4(body, "rk4", threads), euler(body, "semi_implicit_euler", threads);
  const double h = 0.5 * largest_stable_step(rk4), h_euler = 0.5 * largest_stable_step(euler);
  rk4.step(h);
  euler.step(h_euler);
  const State& state = rk4.state();
  const PartModel& m = rk4.model().parts()[0];
  const NodalEnergy& membrane = *part.local()->nodal()->energies()[0];
  const auto triangles = static_cast<double>(part.local()->mesh().triangles.cols());
  const VecX<double> d = state.q.tail(m.n_d());
  VecX<double> f = VecX<double>::Zero(m.n_d());
  NodalEnergy::Buffer buffer;
  ThreadPool pool(threads);
  Workspace<double> work;
  // Each round measures all calls, and each time is the minimum over the rounds, so that a load by other
  // programs does not change the ratios.
  double kernel = std::numeric_limits<double>::infinity(), evaluation = kernel, euler_step = kernel,
         rk4_step = kernel;
  auto update_min = [](double& time, auto&& call) {
    time = std::min(time, bench::seconds_per_call(call, 0.002, 30));
  };
  for (int round = 0; round < 4; ++round) {
    update_min(kernel, [&] { membrane.add_force(d, f, buffer, &pool); });
    update_min(evaluation, [&] { rk4.dynamics().accelerations(0, state.q, state.v, state, work); });
    update_min(euler_step, [&] { euler.step(h_euler); });
    update_min(rk4_step, [&] { rk4.step(h); });
  }
  auto row = [&](const char* name, double seconds, int evaluations) {
    char line[128];
    std::snprintf(line, sizeof line, "%s,%.0f,%d,%.3f,%.2f\n", name, triangles, threads,
                  seconds / triangles * 1e9, seconds / evaluations / kernel);
    std::fputs(line, stdout);
    std::fflush(stdout);
    file.row("%s", line);
  };
  row("kernel", kernel, 1);
  row("evaluation", evaluation, 1);
  row("semi_implicit_euler", euler_step, 1);
  row("rk4", rk4_step, 4);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const char* head = "what,triangles,threads,ns_per_triangle,kernels_per_evaluation\n";
    std::fputs(head, stdout);
    bench::TableFile file(argc > 1 ? std::string(argv[1]) + "/soft_step_bench.csv" : "", head);
    for (const int resolution : {3, 5, 10, 21})
      for (const int threads : {1, 2}) measure(resolution, threads, file);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "soft_step_bench: %s\n", e.what());
    return 1;
  }
}
