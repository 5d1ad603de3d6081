// Work against error on the free solid sphere (r = 0.1 m, E = 1e5 Pa, nu_P = 0.3, 1000 kg/m^3) that rings in
// its torsional mode of two poles, T2 = 24.68711 Hz (Lamb 1882): processor time of a period and relative
// error of the frequency, by basis. Nodes take steps of 0.9 of the largest stable one, modes three a period,
// which they solve exactly. The error of nodes is that of the mode of their mesh, and of the method at the
// step. CSV to standard output; after it what each basis takes at the errors of the table, "not reached"
// where no row does.
//
//   ringing_bench [FOLDER]     writes ringing_bench.csv to FOLDER as well
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include <pliant/part/local_laws.h>
#include <pliant/pliant.h>
#ifdef PLIANT_HAS_SUITESPARSE
#include <pliant/solve/cholmod_factor.h>
#endif

#include "table_file.h"
#include "timing.h"

using namespace pliant;
using Basis = LocalSettings::Basis;

namespace {

constexpr double kFrequency = 24.68711;  // Hz

struct Row {
  std::string basis;
  double error, time;  // time: s a period
};

LocalSettings settings_of(Basis basis, int fineness, int order) {
  LocalSettings settings;
  settings.basis = basis;
  settings.degree = fineness;
  settings.resolution = basis == Basis::polynomial ? 4 : fineness;
  settings.order = order;
  settings.modes = 12;
  settings.energies = {local_law("elastic", {1e5, 0.3})};
#ifdef PLIANT_HAS_SUITESPARSE
  settings.make_factor = [] { return make_cholmod_factor(); };
#endif
  return settings;
}

class Bench {
 public:
  explicit Bench(const std::string& folder)
      : file_(folder.empty() ? "" : folder + "/ringing_bench.csv", head()) {
    std::fputs(head().c_str(), stdout);
  }

  /// By both methods. mesh_frequency: of nodes. Returns the frequency, of modes their own.
  double measure(const std::string& name, Basis basis, int fineness, int order, double mesh_frequency = 0) {
    MultiBody body;
    body.gravity.setZero();
    LocalSettings settings = settings_of(basis, fineness, order);
    settings.velocity = [](const Vec3<double>& X) -> Vec3<double> {  // near T2
      return 0.1 * Vec3<double>(-X[1] * X[2], X[0] * X[2], 0);
    };
    auto& part = body.add<Primitive<Sphere>>("ball", 1000);
    part.rest({{"r", 0.1}}).deform_locally(settings);
    const double setup = bench::seconds_per_call([&] { part.prepare(); }, 0, 1);
    // The five lowest modes are those of T2.
    if (const Oscillators* all = part.local()->oscillators())
      mesh_frequency = all->omega2.head(5).cwiseSqrt().mean() / (2 * kPi);
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      Simulation simulation(body, method);
      const double period = 1 / kFrequency;
      double h = period / 3, error = mesh_frequency / kFrequency - 1;
      if (basis == Basis::nodes) {
        h = 0.9 * largest_stable_step(simulation);
        const double turn = 2 * kPi * kFrequency * h;
        error += std::string(method) == "rk4" ? -std::pow(turn, 4) / 120 : turn * turn / 24;
      }
      const double time =
          bench::seconds_per_call<bench::ProcessorClock>([&] { simulation.step(h); }, 0.002, 60) * period / h;
      char line[256];
      std::snprintf(line, sizeof line, "%s,%d,%d,%s,%.2f,%.4f,%.3f,%.3e\n", name.c_str(), fineness,
                    part.n_v(), method, period / h, time * 1e3, setup, std::abs(error));
      put(line);
      rows_.push_back({name, std::abs(error), time});
    }
    return mesh_frequency;
  }

  void summary() {
    char line[256];
    std::snprintf(line, sizeof line,
                  "# ms a period at most at errors of\n# basis,3%%,1%%,0.1%%,0.01%%,0.001%%\n");
    put(line);
    std::vector<std::string> names;
    for (const Row& row : rows_)
      if (std::find(names.begin(), names.end(), row.basis) == names.end()) names.push_back(row.basis);
    for (const std::string& name : names) {
      std::string text = "# " + name;
      for (const double most : {3e-2, 1e-2, 1e-3, 1e-4, 1e-5}) {
        double best = std::numeric_limits<double>::infinity();
        for (const Row& row : rows_)
          if (row.basis == name && row.error <= most) best = std::min(best, row.time);
        std::snprintf(line, sizeof line, std::isfinite(best) ? ",%.3f" : ",not reached", best * 1e3);
        text += line;
      }
      put((text + "\n").c_str());
    }
  }

 private:
  static std::string head() {
    return "basis,fineness,degrees_of_freedom,method,steps_per_period,ms_per_period,setup_s,"
           "frequency_error\n";
  }
  void put(const char* line) {
    std::fputs(line, stdout);
    std::fflush(stdout);
    file_.row("%s", line);
  }
  bench::TableFile file_;
  std::vector<Row> rows_;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    Bench bench(argc > 1 ? argv[1] : "");
    for (const int degree : {2, 3, 4, 5, 6, 7, 8}) bench.measure("polynomial", Basis::polynomial, degree, 1);
    for (const int order : {2, 1})
      for (const int resolution :
           order == 1 ? std::vector<int>{2, 3, 4, 6, 8, 10, 12, 14} : std::vector<int>{1, 2, 3, 4, 5}) {
        const std::string kind = " of order " + std::to_string(order);
        const double found = bench.measure("modes" + kind, Basis::modes, resolution, order);
        bench.measure("nodes" + kind, Basis::nodes, resolution, order, found);
      }
    bench.summary();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "ringing_bench: %s\n", e.what());
    return 1;
  }
}
