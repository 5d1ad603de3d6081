// Assembly of random layouts before time 0: number of layouts whose joints close, iterations and time.
//
//   assembly_bench [FOLDER] [LAYOUTS]     writes assembly_bench.csv to FOLDER and a table to standard output
//
// A layout is a tree of ellipsoids on ball joints; the first ellipsoid is connected to the world. The poses
// of the ellipsoids are random. Their centres are in a cube about the origin, whose half side is a number of
// body lengths (column distance). Some layouts have up to one more joint for every four parts. These joints
// close loops, and may be impossible to satisfy. LAYOUTS: number of layouts of each kind (default: 1000).
// Kinds with 100 parts have a tenth as many layouts.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/pliant.h>

#include "linkage.h"
#include "table_file.h"

using namespace pliant;
using bench::kLinkAxes;
using bench::kLinkLength;

namespace {

class Layout {
 public:
  /// Adds a random layout to a body. loops: largest number of joints that close loops. distance: half side of
  /// the cube of the centres, in body lengths.
  Layout(MultiBody& body, int parts, int loops, double distance, unsigned seed) : random_(seed) {
    std::vector<const Part*> placed;
    for (int i = 0; i < parts; ++i) {
      auto& part = body.add<Primitive<Ellipsoid>>("part" + std::to_string(i));
      part.rest({{"a1", kLinkAxes[0]}, {"a2", kLinkAxes[1]}, {"a3", kLinkAxes[2]}});
      const Vec3<double> axis(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      part.place(distance * kLinkLength * Vec3<double>(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)),
                 Eigen::Quaterniond(Eigen::AngleAxisd(uniform(0, kPi), axis.normalized())));
      body.ball("joint" + std::to_string(i),
                placed.empty() ? world(0, 0, 0) : random_point(random_part(placed)), random_point(part));
      placed.push_back(&part);
    }
    for (int i = 0; i < loops; ++i) {
      const Part &a = random_part(placed), &b = random_part(placed);
      if (&a != &b) body.ball("loop" + std::to_string(i), random_point(a), random_point(b));
    }
  }

 private:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  const Part& random_part(const std::vector<const Part*>& parts) {
    return *parts[std::uniform_int_distribution<std::size_t>(0, parts.size() - 1)(random_)];
  }
  Point random_point(const Part& part) { return point(part, std::asin(uniform(-1, 1)), uniform(-kPi, kPi)); }

  std::mt19937 random_;
};

/// Sums and maxima over the layouts of a kind. Iterations and gaps (m) are those of layouts whose joints
/// close.
struct Statistics {
  int layouts = 0, closed = 0, max_iterations = 0;
  double iterations = 0, seconds = 0, max_gap = 0;
};

/// Assembles `layouts` random layouts of one kind.
Statistics run(int parts, int loops, double distance, int layouts) {
  Statistics result;
  for (int i = 0; i < layouts; ++i) {
    MultiBody body;
    const Layout layout(body, parts, loops, distance, static_cast<unsigned>(i));
    const Model model(body);
    const Dynamics dynamics(model);
    State state = model.initial_state();
    const auto start = std::chrono::steady_clock::now();
    ++result.layouts;
    try {
      const AssemblyReport report = assemble(dynamics, state);
      ++result.closed;
      result.iterations += report.iterations;
      result.max_iterations = std::max(result.max_iterations, report.iterations);
      result.max_gap = std::max(result.max_gap, report.gap);
    } catch (const UnsatisfiableModel&) {  // not counted as closed
    }
    result.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    bench::TableFile file(
        argc > 1 ? std::string(argv[1]) + "/assembly_bench.csv" : "",
        "parts,loops,distance,layouts,closed,mean_iterations,most_iterations,ms,widest_gap_m\n");
    const int layouts = argc > 2 ? std::atoi(argv[2]) : 1000;
    std::printf("parts loops distance | layouts  closed  iterations  (max)      ms  widest gap, m\n");
    for (const int parts : {1, 4, 12, 100})
      for (const bool looped : {false, true}) {
        const int loops = looped ? parts / 4 : 0;
        if (looped && loops == 0) continue;
        for (const double distance : {3, 10, 100}) {
          const Statistics t = run(parts, loops, distance, parts == 100 ? layouts / 10 : layouts);
          const double iterations = t.closed > 0 ? t.iterations / t.closed : 0,
                       ms = 1e3 * t.seconds / t.layouts;
          std::printf("%5d %5d %8.0f | %7d %7d %8.1f (%4d) %9.3f  %.0e\n", parts, loops, distance, t.layouts,
                      t.closed, iterations, t.max_iterations, ms, t.max_gap);
          file.row("%d,%d,%g,%d,%d,%.2f,%d,%.4f,%.1e\n", parts, loops, distance, t.layouts, t.closed,
                   iterations, t.max_iterations, ms, t.max_gap);
        }
      }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "assembly_bench: %s\n", e.what());
    return 1;
  }
}
