// Assembly before time 0 from random layouts: the share that closes, iterations, time.
//
//   assembly_bench [FOLDER] [LAYOUTS]     writes assembly_bench.csv to FOLDER, a table to standard output
//
// A layout is a tree of ellipsoids on ball joints, the first joined to the world, in random poses within a
// cube of a given number of body lengths. Some have one more joint for every four parts; these loops need not
// be possible. LAYOUTS: number of each kind (1000); a tenth of it for 100 parts.
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
  Layout(MultiBody& body, int parts, int loops, double apart, unsigned seed) : random_(seed) {
    std::vector<const Part*> placed;
    for (int i = 0; i < parts; ++i) {
      auto& part = body.add<Primitive<Ellipsoid>>("part" + std::to_string(i));
      part.rest({{"a1", kLinkAxes[0]}, {"a2", kLinkAxes[1]}, {"a3", kLinkAxes[2]}});
      const Vec3<double> axis(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      part.place(apart * kLinkLength * Vec3<double>(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)),
                 Eigen::Quaterniond(Eigen::AngleAxisd(uniform(0, kPi), axis.normalized())));
      body.ball("joint" + std::to_string(i), placed.empty() ? world(0, 0, 0) : surface(one_of(placed)),
                surface(part));
      placed.push_back(&part);
    }
    for (int i = 0; i < loops; ++i) {
      const Part &a = one_of(placed), &b = one_of(placed);
      if (&a != &b) body.ball("loop" + std::to_string(i), surface(a), surface(b));
    }
  }

 private:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  const Part& one_of(const std::vector<const Part*>& parts) {
    return *parts[std::uniform_int_distribution<std::size_t>(0, parts.size() - 1)(random_)];
  }
  Point surface(const Part& part) { return point(part, std::asin(uniform(-1, 1)), uniform(-kPi, kPi)); }

  std::mt19937 random_;
};

struct Tally {
  int layouts = 0, closed = 0, most_iterations = 0;
  double iterations = 0, seconds = 0, widest = 0;
};

Tally run(int parts, int loops, double apart, int layouts) {
  Tally tally;
  for (int i = 0; i < layouts; ++i) {
    MultiBody body;
    const Layout layout(body, parts, loops, apart, static_cast<unsigned>(i));
    const Model model(body);
    const Dynamics dynamics(model);
    State state = model.initial_state();
    const auto start = std::chrono::steady_clock::now();
    ++tally.layouts;
    try {
      const AssemblyReport report = assemble(dynamics, state);
      ++tally.closed;
      tally.iterations += report.iterations;
      tally.most_iterations = std::max(tally.most_iterations, report.iterations);
      tally.widest = std::max(tally.widest, report.gap);
    } catch (const UnsatisfiableModel&) {  // counts as open
    }
    tally.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return tally;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    bench::TableFile file(
        argc > 1 ? std::string(argv[1]) + "/assembly_bench.csv" : "",
        "parts,loops,apart,layouts,closed,mean_iterations,most_iterations,ms,widest_gap_m\n");
    const int layouts = argc > 2 ? std::atoi(argv[2]) : 1000;
    std::printf("parts loops  apart | layouts  closed  iterations (most)      ms  widest gap, m\n");
    for (const int parts : {1, 4, 12, 100})
      for (const bool looped : {false, true}) {
        const int loops = looped ? parts / 4 : 0;
        if (looped && loops == 0) continue;
        for (const double apart : {3, 10, 100}) {
          const Tally t = run(parts, loops, apart, parts == 100 ? layouts / 10 : layouts);
          const double iterations = t.closed > 0 ? t.iterations / t.closed : 0,
                       ms = 1e3 * t.seconds / t.layouts;
          std::printf("%5d %5d %6.0f | %7d %7d %8.1f (%4d) %9.3f  %.0e\n", parts, loops, apart, t.layouts,
                      t.closed, iterations, t.most_iterations, ms, t.widest);
          file.row("%d,%d,%g,%d,%d,%.2f,%d,%.4f,%.1e\n", parts, loops, apart, t.layouts, t.closed, iterations,
                   t.most_iterations, ms, t.widest);
        }
      }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "assembly_bench: %s\n", e.what());
    return 1;
  }
}
