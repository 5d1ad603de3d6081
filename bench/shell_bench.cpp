// Time per triangle of a force evaluation for each shell energy, on spheres. Writes CSV to standard output.
// Further columns are the multiply-adds (the larger of the numbers of products and sums) and the bytes per
// triangle, counted from the formulas. The columns part_of_peak and part_of_bandwidth compare the evaluation
// with two speeds of one thread, which this run measures: the peak of multiply-adds, and the bandwidth of a
// triad (a = b + s c) over arrays with as many bytes in total as the evaluation uses. Per triangle,
//   part_of_peak = multiply_adds / (peak * threads * time),
//   part_of_bandwidth = bytes / (bandwidth * threads * time).
//
//   shell_bench [FOLDER]     also writes shell_bench.csv to FOLDER
#include <cmath>
#include <cstdio>
#include <string>

#include <pliant/local/shell/bending.h>
#include <pliant/local/shell/linear_membrane.h>
#include <pliant/local/shell/loaded_membrane.h>
#include <pliant/local/shell/membrane.h>
#include <pliant/local/shell/pressure.h>

#include "../tests/local/shell_meshes.h"
#include "table_file.h"
#include "timing.h"

using namespace pliant;

namespace {

/// Multiply-adds and bytes per triangle. On average there are 0.5 nodes and 1.5 edges per triangle.
struct Work {
  double multiply_adds, bytes;
};
/// Returns the bytes per triangle of the nodal data. corners: number of corners of an element; elements:
/// number of elements per triangle. For each corner the evaluation reads coordinates and a node number,
/// writes the force of the corner to a buffer, and later reads the position of the force in the buffer and
/// the force. For each node it reads and writes the force.
double gather_bytes(int corners, double elements) {
  return elements * corners * (3 * 8 + 2 * 3 * 8 + 4 + 4) + 0.5 * 2 * 3 * 8;
}

struct Bench {
  double peak;
  bench::TableFile& file;

  void measure(const std::string& name, const ShellMesh& mesh, const NodalEnergy& energy,
               const Work& work) const {
    VecX<double> x(3 * mesh.n_nodes() + energy.own_inertia().size());
    x.setZero();
    if (energy.of() == NodalEnergy::Of::position) x.head(3 * mesh.n_nodes()) = mesh.X().reshaped();
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += 1e-3 * std::sin(static_cast<double>(i));
    VecX<double> f = VecX<double>::Zero(x.size());
    NodalEnergy::Buffer buffer;
    const auto triangles = static_cast<double>(mesh.n_triangles());
    const double bandwidth = bench::triad_bandwidth(static_cast<std::size_t>(work.bytes * triangles));
    for (const int threads : {1, 2}) {
      ThreadPool pool(threads);
      const double seconds =
          bench::seconds_per_call([&] { energy.add_force(x, f, buffer, &pool); }) / triangles;
      const double arithmetic = work.multiply_adds / peak / threads,
                   memory = work.bytes / bandwidth / threads;
      char line[256];
      std::snprintf(line, sizeof line, "%s,%.0f,%d,%.3f,%.0f,%.0f,%.1f,%.2f,%.2f\n", name.c_str(), triangles,
                    threads, seconds * 1e9, work.multiply_adds, work.bytes, bandwidth * 1e-9,
                    arithmetic / seconds, memory / seconds);
      std::fputs(line, stdout);
      std::fflush(stdout);
      file.row("%s", line);
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  char head[256];
  const double peak = bench::multiply_add_peak();
  std::snprintf(head, sizeof head,
                "# peak of one thread: %.2f 1e9 multiply-adds/s\n"
                "energy,triangles,threads,ns_per_triangle,multiply_adds,bytes,triad_gb_per_s,part_of_peak,"
                "part_of_bandwidth\n",
                peak * 1e-9);
  std::fputs(head, stdout);
  bench::TableFile file(argc > 1 ? std::string(argv[1]) + "/shell_bench.csv" : "", head);
  const Bench bench{peak, file};
  const Sheet sheet{1e5, 0.3, 0.01};
  for (const int levels : {2, 3, 4, 5}) {
    const ShellMesh mesh = test::icosphere(levels, 1);
    const double three = gather_bytes(3, 1), hinges = gather_bytes(4, 1.5);
    bench.measure("linear membrane", mesh, LinearMembrane(mesh, sheet), {39, three + 12 * 8});
    bench.measure("loaded membrane", mesh, LoadedMembrane(mesh, {1, 1}), {42, three + 5 * 8});
    bench.measure("St. Venant-Kirchhoff", mesh, StVenantKirchhoffMembrane(mesh, sheet), {42, three + 9 * 8});
    bench.measure("neo-Hookean", mesh, NeoHookeanMembrane(mesh, sheet), {110, three + 9 * 8});
    bench.measure("neo-Hookean incompressible", mesh, NeoHookeanMembrane(mesh, {1e5, 0.5, 0.01}),
                  {65, three + 9 * 8});
    bench.measure("constant pressure", mesh, ConstantPressure(mesh, 1), {40, 1.5 * three});
    // Additional data of a hinge: its angle, two moments and their indices. LinearBending reads the gradient
    // of the angle twice. FoldingBending reads the coordinates again, and the sine and cosine of the rest
    // angle.
    //
    // Data of a triangle: the matrices Q and C of bending.h, for each edge the side on which the triangle is,
    // indices of edges and angles, and moments, which are written and read. LinearBending reads the edge
    // vectors twice. FoldingBending reads the strain at rest.
    const double triangles = gather_bytes(3, 2) + (6 + 9 + 3 + 3 + 2 * 3) * 8;
    bench.measure("linear bending", mesh, LinearBending(mesh, sheet, 1),
                  {120, hinges + 1.5 * (2 * 12 + 4) * 8 + triangles + 2 * 9 * 8});
    bench.measure("folding bending", mesh, FoldingBending(mesh, sheet, 1),
                  {400, hinges + 1.5 * (12 + 2 + 4) * 8 + triangles + 3 * 8});
  }
}
