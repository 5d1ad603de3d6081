// Run time against error of free vibrations of two bodies (r = 0.1 m, E = 1e5 Pa, 1000 kg/m^3, Poisson's
// ratio 0.3). The frequencies are those of Lamb (1882). A solid sphere has its lowest torsional mode T2 at
// 24.68711 Hz and its lowest spheroidal mode S2 at 26.11917 Hz. A closed membrane, 1 mm thick, has its lowest
// modes n = 2 at 11.695 Hz. Higher modes of the membrane are not measured, because on a mesh they are mixed
// with modes of short waves.
//
// For each basis, the table has the processor time for a simulated period of the lowest mode and the relative
// errors of the frequencies. With the basis "nodes", the step is 0.9 times the largest stable step. With
// modes and polynomials there are three steps per period, and free oscillators are integrated exactly. The
// error of the basis "nodes" is the error of the frequency of the mesh plus the error of the method of
// integration. The frequency of the mesh is computed with the basis "modes". For order 2 this overestimates
// the error: the basis "modes" uses elements of 10 nodes, and the basis "nodes" uses elements of 15 nodes,
// which are more accurate.
//
// Writes CSV to standard output, and then the time of each basis at given errors of the lower mode and of
// both modes. An entry is "not reached" if no row has at most the given error.
//
//   ringing_bench [FOLDER]     writes ringing_bench.csv to FOLDER as well
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include <pliant/part/local/local_laws.h>
#include <pliant/pliant.h>
#ifdef PLIANT_HAS_SUITESPARSE
#include <pliant/solve/cholmod_factor.h>
#endif

#include "table_file.h"
#include "timing.h"

using namespace pliant;
using Basis = LocalSettings::Basis;

namespace {

constexpr double kRadius = 0.1, kYoung = 1e5, kPoisson = 0.3, kDensity = 1000, kThickness = 1e-3;

/// A natural frequency, Hz, and the number of modes that have it.
struct Mode {
  double frequency;
  int multiplicity;
};

/// Returns the root of f in [low, high], where f changes its sign.
template <class F>
double root(F&& f, double low, double high) {
  for (const bool rises = f(low) < 0; high - low > 1e-15 * high;) {
    const double middle = 0.5 * (low + high);
    if (!(low < middle && middle < high)) break;
    ((f(middle) < 0) == rises ? low : high) = middle;
  }
  return low;
}

/// Returns the modes T2 and S2 of the solid sphere, from the roots eta = omega r / c_t of their equations.
/// c_t and c_l: speeds of shear and pressure waves.
std::vector<Mode> lamb_modes() {
  const auto j = [](int l, double x) { return std::sph_bessel(static_cast<unsigned>(l), x); };
  const double torsional = root([&](double y) { return j(2, y) - y * j(3, y); }, 2.4, 2.6);
  const double slowness = std::sqrt((1 - 2 * kPoisson) / (2 * (1 - kPoisson)));  // c_t / c_l
  const double spheroidal = root(
      [&](double y) {
        const double x = y * slowness;
        return ((2 - 0.5 * y * y) * j(2, x) + 2 * x * j(3, x)) * ((3 - 0.5 * y * y) * j(2, y) + y * j(3, y)) -
               6 * (j(2, y) - y * j(3, y)) * (j(2, x) - x * j(3, x));
      },
      2.5, 2.8);
  const double unit = std::sqrt(kYoung / (2 * (1 + kPoisson)) / kDensity) / (2 * kPi * kRadius);
  return {{torsional * unit, 5}, {spheroidal * unit, 5}};
}

/// Returns the modes n = 2 of the closed membrane.
std::vector<Mode> membrane_modes() {
  const auto mode = [](int n) -> Mode {
    const double b = n * n + n + 1 + 3 * kPoisson, c = 4 * (1 - kPoisson * kPoisson) * (n * n + n - 2);
    const double Omega2 = 0.5 * (b - std::sqrt(b * b - c));
    return {std::sqrt(Omega2 * kYoung / (kDensity * (1 - kPoisson * kPoisson))) / (2 * kPi * kRadius),
            2 * n + 1};
  };
  return {mode(2)};
}

struct Row {
  std::string basis;
  // error: relative error of the frequency of the lower mode; error_of_both: the larger error of both modes;
  // time: processor time, s per period of the lower mode.
  double error, error_of_both, time;
};

/// A measured case: a solid or shell with a basis of its deformation. fineness: degree of the polynomials, or
/// resolution of the mesh. order: order of the elements.
struct Case {
  std::string name;
  bool shell;
  Basis basis;
  int fineness, order;
};

LocalSettings settings_of(const Case& measured) {
  LocalSettings settings;
  settings.basis = measured.basis;
  settings.degree = measured.fineness;
  settings.resolution = measured.basis == Basis::polynomial ? 4 : measured.fineness;
  settings.order = measured.order;
  settings.modes = 12;
  if (measured.shell)
    settings.energies = {local_law("membrane", {kYoung, kPoisson, kThickness})};
  else
    settings.energies = {local_law("elastic", {kYoung, kPoisson})};
#ifdef PLIANT_HAS_SUITESPARSE
  settings.make_factor = [] { return make_cholmod_factor(); };
#endif
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> {  // close to the mode T2
    return 0.1 * Vec3<double>(-X[1] * X[2], X[0] * X[2], 0);
  };
  return settings;
}

class Bench {
 public:
  explicit Bench(const std::string& folder)
      : file_(folder.empty() ? "" : folder + "/ringing_bench.csv", head()) {
    std::fputs(head().c_str(), stdout);
  }

  /// Measures a case with both methods of integration. mesh_frequencies: for the basis "nodes", the
  /// frequencies of the modes of the same mesh, Hz; not used otherwise. Returns the frequencies of the modes
  /// of the case, Hz; for the basis "nodes", mesh_frequencies.
  std::vector<double> measure(const Case& measured, std::vector<double> mesh_frequencies = {}) {
    const std::vector<Mode> exact = measured.shell ? membrane_modes() : lamb_modes();
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add<Primitive<Sphere>>("ball", measured.shell ? kDensity * kThickness : kDensity);
    part.rest({{"r", kRadius}});
    if (measured.shell) part.make_shell();
    part.deform_locally(settings_of(measured));
    const double setup = bench::seconds_per_call([&] { part.prepare(); }, 0, 1);
    if (const Oscillators* all = part.local()->oscillators()) {
      Eigen::Index first = 0;
      mesh_frequencies.clear();
      for (const Mode& mode : exact) {
        mesh_frequencies.push_back(all->omega2.segment(first, mode.multiplicity).cwiseSqrt().mean() /
                                   (2 * kPi));
        first += mode.multiplicity;
      }
    }
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      Simulation simulation(body, method);
      const double period = 1 / exact[0].frequency;
      double h = period / 3;
      if (measured.basis == Basis::nodes) h = 0.9 * largest_stable_step(simulation);
      std::vector<double> errors;
      for (std::size_t k = 0; k < exact.size(); ++k) {
        double error = mesh_frequencies[k] / exact[k].frequency - 1;
        const double phase = 2 * kPi * exact[k].frequency * h;
        if (measured.basis == Basis::nodes)
          error += std::string(method) == "rk4" ? -std::pow(phase, 4) / 120 : phase * phase / 24;
        errors.push_back(std::abs(error));
      }
      const double time =
          bench::seconds_per_call<bench::ProcessorClock>([&] { simulation.step(h); }, 0.002, 60) * period / h;
      char line[256];
      std::snprintf(line, sizeof line, "%s,%d,%d,%s,%.2f,%.4f,%.3f,%.3e,%.3e\n", measured.name.c_str(),
                    measured.fineness, part.n_v(), method, period / h, time * 1e3, setup, errors.front(),
                    errors.back());
      put(line);
      rows_.push_back({measured.name, errors.front(), std::max(errors.front(), errors.back()), time});
    }
    return mesh_frequencies;
  }

  /// Writes the smallest time of each basis at each level of the error, as comment lines.
  void summary() {
    std::vector<std::string> names;
    for (const Row& row : rows_)
      if (std::find(names.begin(), names.end(), row.basis) == names.end()) names.push_back(row.basis);
    put("# smallest time in ms per period of the lower mode, for errors of at most\n# "
        "basis,modes,3%,1%,0.1%,0.01%,0.001%\n");
    for (const std::string& name : names)
      for (const bool both : {false, true}) {
        std::string text = "# " + name + (both ? ",both" : ",lower");
        for (const double level : {3e-2, 1e-2, 1e-3, 1e-4, 1e-5}) {
          double min_time = std::numeric_limits<double>::infinity();
          for (const Row& row : rows_)
            if (row.basis == name && (both ? row.error_of_both : row.error) <= level)
              min_time = std::min(min_time, row.time);
          char cell[64];
          std::snprintf(cell, sizeof cell, std::isfinite(min_time) ? ",%.3f" : ",not reached",
                        min_time * 1e3);
          text += cell;
        }
        put((text + "\n").c_str());
      }
  }

 private:
  static std::string head() {
    return "basis,fineness,degrees_of_freedom,method,steps_per_period,ms_per_period,setup_s,error_of_lower,"
           "error_of_upper\n";
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
    for (const int degree : {2, 3, 4, 5, 6, 7, 8})
      bench.measure({"polynomial", false, Basis::polynomial, degree, 1});
    for (const int order : {2, 1})
      for (const int resolution :
           order == 1 ? std::vector<int>{2, 3, 4, 6, 8, 10, 12, 14} : std::vector<int>{1, 2, 3, 4, 5}) {
        const std::string kind = " of order " + std::to_string(order);
        const auto found = bench.measure({"modes" + kind, false, Basis::modes, resolution, order});
        bench.measure({"nodes" + kind, false, Basis::nodes, resolution, order}, found);
      }
    for (const int resolution : {2, 3, 5, 8, 12, 20, 32}) {
      const auto found = bench.measure({"modes of a shell", true, Basis::modes, resolution, 1});
      bench.measure({"nodes of a shell", true, Basis::nodes, resolution, 1}, found);
    }
    bench.summary();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "ringing_bench: %s\n", e.what());
    return 1;
  }
}
