// Time of one force evaluation of solid energies, for each element, law, size and number of threads. Writes
// CSV to standard output, after a comment about the columns. Operations are counted by evaluating the
// formulas of an element with a number type that counts (counted.h). Bytes are those that an evaluation reads
// and writes: constants of the quadrature points, node numbers, element forces (written and read back), and
// the coordinates and forces of each node once. The bandwidth is that of a triad (a = b + s c) over arrays
// with the same number of bytes in total, so that both use the same level of the caches.
//
//   solid_bench [FOLDER]     also writes solid_bench.csv to FOLDER
#include <cstdio>
#include <exception>
#include <string>

#include <pliant/local/solid/averaged_dilatation.h>
#include <pliant/local/solid/solid_energy.h>
#include <pliant/pliant.h>

#include "counted.h"
#include "table_file.h"
#include "timing.h"

using namespace pliant;

namespace {

const Elasticity kMaterial(1e5, 0.3);

struct Machine {
  double multiply_adds;  // multiply-adds per second of one core
};

struct Mesh {
  Nodes rest;
  Eigen::MatrixXi elements;
};

Mesh sphere(int resolution, Solid::Order order) {
  const auto part = make_part("ball", "sphere", {}, 1000);
  const Solid solid(*part, resolution, order);
  return {part->s(solid.material(), part->parameters().rest()).transpose(), solid.elements()};
}

/// Returns the number of operations of one element. The function runs the kernel of SolidEnergy with the
/// number type Counted.
template <class Element, class Law>
long operations() {
  using bench::Counted;
  constexpr int N = Element::n_nodes;
  const Mesh mesh = sphere(1, N == 4    ? Solid::Order::linear
                              : N == 10 ? Solid::Order::quadratic
                                        : Solid::Order::enriched);
  Vec3<Counted> x[N], f[N];
  for (int a = 0; a < N; ++a) x[a] = mesh.rest.row(mesh.elements(a, 0)).transpose().template cast<Counted>();
  for (Vec3<Counted>& force : f) force.setConstant(Counted(0.0));
  Mat3<Counted> inverse = Mat3<Counted>::Constant(Counted(0.0));
  for (int i = 0; i < 3; ++i) inverse(i, i) = Counted(1.0);
  Counted::operations = 0;
  for (const TetrahedronPoint& at : Element::rule) {
    Mat3<Counted> G = product(Element::gradient(at, x), inverse);
    const long before = Counted::operations;
    if (Law::of == NodalEnergy::Of::position) G = inverse;  // the deformation gradient is I, as at rest
    Counted::operations = before;
    Element::add_nodal_forces(at, product_transposed(scaled(Counted(1.0), Law(kMaterial).stress(G)), inverse),
                              f);
  }
  return Counted::operations;
}

struct Row {
  const char* name;
  int n_nodes;  // nodes of an element
  long operations, bytes;
};

void measure(const Row& row, const NodalEnergy& energy, const Mesh& mesh, const Machine& machine,
             bench::TableFile& file) {
  VecX<double> x = energy.of() == NodalEnergy::Of::position ? VecX<double>(mesh.rest.reshaped())
                                                            : VecX<double>::Zero(mesh.rest.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += 1e-4 * static_cast<double>((i * 7919) % 101 - 50) / 50;
  VecX<double> f = VecX<double>::Zero(x.size());
  NodalEnergy::Buffer buffer;
  const auto elements = static_cast<double>(mesh.elements.cols());
  energy.add_force(x, f, buffer, nullptr);
  const double bytes = static_cast<double>(row.bytes) + (76.0 * static_cast<double>(mesh.rest.rows()) +
                                                         16.0 * static_cast<double>(buffer.numbers.size())) /
                                                            elements;
  const double bandwidth = bench::triad_bandwidth(static_cast<std::size_t>(bytes * elements));
  for (int threads : {1, 2}) {
    ThreadPool pool(threads);
    const double time = bench::seconds_per_call([&] { energy.add_force(x, f, buffer, &pool); }) / elements;
    const double peak = static_cast<double>(row.operations) / (2 * machine.multiply_adds * time * threads);
    char line[256];
    std::snprintf(line, sizeof line, "%s,%d,%ld,%ld,%d,%.2f,%ld,%.0f,%.2f,%.2f,%.1f,%.3f,%.3f\n", row.name,
                  row.n_nodes, static_cast<long>(mesh.elements.cols()), static_cast<long>(mesh.rest.rows()),
                  threads, time * 1e9, row.operations, bytes,
                  static_cast<double>(row.operations) / time * 1e-9, bytes / time * 1e-9, bandwidth * 1e-9,
                  peak, bytes / time / bandwidth);
    std::fputs(line, stdout);
    std::fflush(stdout);
    file.row("%s", line);
  }
}

template <class Element>
constexpr long bytes_of() {
  return 80 * static_cast<long>(Element::rule.size()) + Element::n_nodes * 8;
}

template <class Element, class Law>
void measure_law(const char* name, const Mesh& mesh, const Machine& machine, bench::TableFile& file) {
  const SolidEnergy<Element, Law> energy(mesh.rest, mesh.elements, Law(kMaterial));
  measure({name, Element::n_nodes, operations<Element, Law>(), bytes_of<Element>()}, energy, mesh, machine,
          file);
}

template <class Element>
void measure_all(const Mesh& mesh, const Machine& machine, bench::TableFile& file) {
  measure_law<Element, LinearLaw>("linear", mesh, machine, file);
  // Operations added to those of the linear energy: 6 per node of an element for its volume change, and 3 per
  // node for the forces of its mean dilatation.
  constexpr long N = Element::n_nodes;
  const AveragedLinearSolid<Element> averaged(mesh.rest, mesh.elements, kMaterial);
  measure({"averaged_linear", N, operations<Element, LinearLaw>() + 9 * N,
           bytes_of<Element>() + N * (2 * 24 + 2 * 8)},
          averaged, mesh, machine, file);
  measure_law<Element, StVenantKirchhoff>("st_venant_kirchhoff", mesh, machine, file);
  measure_law<Element, NeoHookean>("neo_hookean", mesh, machine, file);
  measure_law<Element, Corotated>("corotated", mesh, machine, file);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Machine machine{bench::multiply_add_peak()};
    char head[512];
    std::snprintf(head, sizeof head,
                  "# peak of one core: %.2f 1e9 multiply-adds/s; share_of_peak: of the peak of all cores in "
                  "use; share_of_bandwidth: of the triad bandwidth of one core\n"
                  "law,element_nodes,elements,nodes,threads,ns_per_element,operations,bytes,gflops,gb_per_s,"
                  "triad_gb_per_s,share_of_peak,share_of_bandwidth\n",
                  machine.multiply_adds * 1e-9);
    std::fputs(head, stdout);
    bench::TableFile file(argc > 1 ? std::string(argv[1]) + "/solid_bench.csv" : "", head);
    for (int resolution : {4, 8, 20})
      measure_all<LinearTetrahedron>(sphere(resolution, Solid::Order::linear), machine, file);
    for (int resolution : {2, 4, 10})
      measure_all<QuadraticTetrahedron>(sphere(resolution, Solid::Order::quadratic), machine, file);
    for (int resolution : {2, 4, 8})
      measure_all<EnrichedTetrahedron>(sphere(resolution, Solid::Order::enriched), machine, file);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "solid_bench: %s\n", e.what());
    return 1;
  }
}
