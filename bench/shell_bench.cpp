// Time per triangle of a force evaluation by each shell energy, on spheres. CSV to standard output. Beside it
// what an evaluation computes (multiply-adds: the larger of its products and its sums) and moves (bytes),
// counted from the formulas, and how much of the bound by this machine's measured multiply-add peak and triad
// bandwidth it reaches.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <pliant/local/bending.h>
#include <pliant/local/linear_membrane.h>
#include <pliant/local/loaded_membrane.h>
#include <pliant/local/membrane.h>
#include <pliant/local/pressure.h>

#include "../tests/local/shell_meshes.h"
#include "timing.h"

using namespace pliant;

namespace {

/// Per triangle; a triangle has half a node and three halves of an edge.
struct Work {
  double multiply_adds, bytes;
};
/// What a node gathers from the corners of K-cornered elements, `elements` a triangle: coordinates read,
/// forces written and read, their places and the nodes' numbers, forces of nodes.
double gather_bytes(int corners, double elements) {
  return elements * corners * (3 * 8 + 2 * 3 * 8 + 4 + 4) + 0.5 * 2 * 3 * 8;
}

struct Bench {
  double peak, bandwidth;

  void measure(const std::string& name, const ShellMesh& mesh, const NodalEnergy& energy,
               const Work& work) const {
    VecX<double> x(3 * mesh.n_nodes() + energy.own_inertia().size());
    x.setZero();
    if (energy.of() == NodalEnergy::Of::position) x.head(3 * mesh.n_nodes()) = mesh.X().reshaped();
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += 1e-3 * std::sin(static_cast<double>(i));
    VecX<double> f = VecX<double>::Zero(x.size());
    NodalEnergy::Buffer buffer;
    for (const int threads : {1, 2}) {
      ThreadPool pool(threads);
      const double seconds =
          bench::seconds_per_call([&] { energy.add_force(x, f, buffer, &pool); }, 0.02, 7) /
          static_cast<double>(mesh.n_triangles());
      const double bound = std::max(work.multiply_adds / peak, work.bytes / bandwidth) / threads;
      std::printf("%s,%ld,%d,%.3f,%.0f,%.0f,%.2f\n", name.c_str(), static_cast<long>(mesh.n_triangles()),
                  threads, seconds * 1e9, work.multiply_adds, work.bytes, bound / seconds);
      std::fflush(stdout);
    }
  }
};

}  // namespace

int main() {
  const Bench bench{bench::multiply_add_peak(), bench::triad_bandwidth()};
  std::printf("# multiply-adds per second %.3g, triad %.3g bytes/s, one thread\n", bench.peak,
              bench.bandwidth);
  std::printf("energy,triangles,threads,ns_per_triangle,multiply_adds,bytes,part_of_bound\n");
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
    // Hinges: gradients or rest angles, angles, moments. Triangles: Q, C, sides, numbers of edges and angles,
    // moments.
    const double triangles = gather_bytes(3, 2) + (6 + 9 + 3 + 3 + 2 * 3) * 8;
    bench.measure("linear bending", mesh, LinearBending(mesh, sheet, 1),
                  {120, hinges + 1.5 * (2 * 12 + 4) * 8 + triangles + 2 * 9 * 8});
    bench.measure("folding bending", mesh, FoldingBending(mesh, sheet, 1),
                  {400, hinges + 1.5 * (12 + 2 + 4) * 8 + triangles + 3 * 8});
  }
}
