// The loaded membrane against its exact spectra, on the parameter rectangle and on the sphere, and the checks
// of energy_laws.h.
#include <pliant/local/shell/loaded_membrane.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/mesh/parameter_mesh.h>
#include <pliant/part/registry.h>

#include "catch.h"
#include "modes.h"
#include "sparse_modes.h"

namespace loaded_membrane_test {

using namespace pliant;
using namespace pliant::test;

namespace {

/// Returns a mesh of the rectangle -pi/2 <= u <= pi/2, -pi <= v < pi, with `rows` strips along u and
/// `columns` along v. The mesh is periodic in v and has one node at each pole.
ParameterMesh parameter_grid(int rows, int columns) {
  ParameterMesh mesh{(rows - 1) * columns + 2, {}, {}};
  mesh.triangles.resize(3, 2 * rows * columns);
  mesh.uv.resize(2, 6 * rows * columns);
  auto node = [&](int i, int j) {
    if (i == 0) return static_cast<int>(mesh.n_nodes) - 2;
    if (i == rows) return static_cast<int>(mesh.n_nodes) - 1;
    return (i - 1) * columns + j % columns;
  };
  Eigen::Index t = 0;
  auto add = [&](std::array<std::array<int, 2>, 3> corners) {
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = corners[static_cast<std::size_t>(k)];
      mesh.triangles(k, t) = node(i, j);
      mesh.uv.col(3 * t + k) << kPi * i / rows - kPi / 2, 2 * kPi * j / columns - kPi;
    }
    ++t;
  };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
      add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  return mesh;
}

/// Returns the masses of the nodes for the mass mu per du dv. Each node has a third of the mass of its
/// triangles.
VecX<double> parameter_masses(const ParameterMesh& mesh, double mu) {
  VecX<double> M = VecX<double>::Zero(mesh.n_nodes);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector2d p = mesh.uv.col(3 * t + 1) - mesh.uv.col(3 * t),
                          q = mesh.uv.col(3 * t + 2) - mesh.uv.col(3 * t);
    for (int k = 0; k < 3; ++k) M[mesh.triangles(k, t)] += mu * std::abs(p[0] * q[1] - p[1] * q[0]) / 6;
  }
  return M;
}

/// Returns all omega^2 of the displacement along x, in rising order. M: masses of the nodes.
VecX<double> spectrum(const NodalEnergy& energy, const VecX<double>& M) {
  const Eigen::Index n = M.size();
  const Eigen::SparseMatrix<double> K = stiffness(energy, VecX<double>::Zero(3 * n)).topLeftCorner(n, n);
  const VecX<double> root = M.cwiseSqrt().cwiseInverse();
  const MatX<double> scaled = root.asDiagonal() * MatX<double>(K) * root.asDiagonal();
  return symmetric_eigenvalues(scaled);
}

/// Returns the lowest `wanted` omega^2 of the displacement along x, for the law "loaded_membrane_uv" on the
/// mesh of a part, with the mass mu du dv.
VecX<double> part_spectrum(const char* shape, int resolution, double w0, double w1, double mu, int wanted) {
  const auto part = make_part("skin", shape, {}, 1);
  LocalSettings settings;
  settings.resolution = resolution;
  settings.energies = {local_law("loaded_membrane_uv", {w0, w1})};
  part->make_shell().deform_locally(settings);
  part->prepare();
  const NodalDeformation& local = *part->local()->nodal();
  const Eigen::Index n = local.n_nodes();
  const Sparse K = stiffness_at(*local.energies()[0], VecX<double>::Zero(3 * n)).topLeftCorner(n, n);
  const Sparse M(parameter_masses(parameter_mesh(local.mesh()), mu).asDiagonal());
  return modes_near(K, M, 0, wanted).values;
}

}  // namespace

TEST_CASE("loaded membrane: the spectrum of the parameter rectangle with poles", "[local]") {
  // omega^2 = (w0 + w1 (m^2 + n^2))/mu, with wave numbers m along v and n along u. For m = 0, n is 0, 1, ...
  // For each m >= 1, n is 1, 2, ..., with two modes each, which are zero at the poles.
  const double w0 = 0.3, w1 = 2, mu = 1.7;
  const std::array<int, 10> exact{0, 1, 2, 2, 4, 5, 5, 5, 5, 8};
  VecX<double> error[2];
  for (const int k : {0, 1}) {
    const ParameterMesh mesh = parameter_grid(12 << k, 24 << k);
    const VecX<double> values =
        spectrum(LoadedMembrane(mesh, {w0, w1, Load::Size::lumped}), parameter_masses(mesh, mu));
    error[k] = VecX<double>(10);
    for (int i = 0; i < 10; ++i)
      error[k][i] = std::abs(mu * values[i] / (w0 + w1 * exact[static_cast<std::size_t>(i)]) - 1);
  }
  CHECK(error[1][0] <= 1e-9);
  for (int i = 1; i < 10; ++i) {
    INFO("mode " << i << ": errors " << error[0][i] << ", " << error[1][i]);
    CHECK(error[1][i] <= 0.012);
    CHECK(std::log2(error[0][i] / error[1][i]) >= 1.85);
  }
}

TEST_CASE("loaded membrane: the spectrum of the parameter rectangle on the mesh of a torus", "[local]") {
  // omega^2 = (w0 + w1 (m^2 + n^2))/mu for all integers m and n: the rectangle is periodic in both
  // directions.
  const double w0 = 0.3, w1 = 2, mu = 1.7;
  const std::array<int, 9> exact{0, 1, 1, 1, 1, 2, 2, 2, 2};
  const VecX<double> coarse = part_spectrum("supertoroid", 4, w0, w1, mu, 9),
                     fine = part_spectrum("supertoroid", 8, w0, w1, mu, 9);
  auto error = [&](const VecX<double>& values, int i) {
    return std::abs(mu * values[i] / (w0 + w1 * exact[static_cast<std::size_t>(i)]) - 1);
  };
  CHECK(error(fine, 0) <= 1e-11);
  for (int i = 1; i < 9; ++i) {
    INFO("mode " << i << ": errors " << error(coarse, i) << ", " << error(fine, i));
    CHECK(error(fine, i) <= 0.004);
    CHECK(std::log2(error(coarse, i) / error(fine, i)) >= 1.95);
  }
}

TEST_CASE("loaded membrane: the spectrum of the parameter rectangle on the mesh of a ball", "[local][long]") {
  // The spectrum is that of the rectangle with poles. Rings around a pole have 8, 16, ... nodes; on the first
  // ring they are pi/4 apart in v, however fine the mesh is. Near a pole, a mode with m >= 1 is proportional
  // to the distance x from the pole. On ring k, x = k h with the edge length h. The linear interpolation
  // between the nodes of this ring, which are pi/(4k) apart, has an error of the order of x/k^2 = h/k. In a
  // strip of width h beside the ring, the slope across the ring therefore has an error of the order of 1/k.
  // Over all rings, the error of omega^2 is of first order in h. Modes with m = 0 do not depend on v.
  const double w0 = 0.3, w1 = 2, mu = 1.7;
  const std::array<int, 12> exact{0, 1, 2, 2, 4, 5, 5, 5, 5, 8, 8, 9};
  const auto along_u = [](int i) { return i == 1 || i == 4 || i == 11; };  // modes with m = 0
  std::array<VecX<double>, 3> error;
  for (const int k : {0, 1, 2}) {
    const VecX<double> values = part_spectrum("sphere", 8 << k, w0, w1, mu, 12);
    error[static_cast<std::size_t>(k)].resize(12);
    for (int i = 0; i < 12; ++i)
      error[static_cast<std::size_t>(k)][i] =
          mu * values[i] / (w0 + w1 * exact[static_cast<std::size_t>(i)]) - 1;
  }
  CHECK(std::abs(error[2][0]) <= 1e-10);
  for (int i = 1; i < 12; ++i) {
    INFO("mode " << i << ": errors " << error[0][i] << ", " << error[1][i] << ", " << error[2][i]);
    CHECK(std::abs(error[2][i]) <= (along_u(i) ? 0.0005 : 0.0082));
    CHECK(std::log2(error[1][i] / error[2][i]) >= (along_u(i) ? 1.95 : 0.78));
  }
}

TEST_CASE("loaded membrane: the spectrum of the sphere", "[local]") {
  // omega^2 = (w0 + w1 l (l + 1)/r^2)/sigma, with 2 l + 1 modes for each of x, y and z.
  const double w0 = 40, w1 = 5, sigma = 0.6, r = 0.8;
  for (const Load::Size size : {Load::Size::lumped, Load::Size::consistent}) {
    std::array<double, 3> error[2];
    for (const int k : {0, 1}) {
      const ShellMesh mesh = icosphere(2 + k, r);
      const VecX<double> values = spectrum(LoadedMembrane(mesh, {w0, w1, size}), sigma * sphere_areas(mesh));
      for (int l = 0, at = 0; l < 3; at += 2 * l + 1, ++l) {
        const double exact = (w0 + w1 * l * (l + 1) / (r * r)) / sigma;
        error[k][static_cast<std::size_t>(l)] = std::abs(values.segment(at, 2 * l + 1).mean() / exact - 1);
      }
    }
    for (std::size_t l = 0; l < 3; ++l) {
      INFO("l " << l << ": errors " << error[0][l] << ", " << error[1][l]);
      CHECK(error[1][l] <= 0.02);
      CHECK(std::log2(error[0][l] / error[1][l]) >= 1.9);
    }
  }
}

TEST_CASE("loaded membrane: derivatives, matrix, threads, frequency bound, translation", "[local]") {
  Draws draws(2);
  const ShellMesh small = icosphere(1, 0.7), large = icosphere(4, 0.7);
  for (const Load::Size size : {Load::Size::lumped, Load::Size::consistent}) {
    const LoadedMembrane on_surface(small, {0.4, 3, size}), more(large, {0.4, 3, size});
    const VecX<double> x = random_vector(draws, 3 * small.n_nodes());
    check_slopes(on_surface, x, 0.1);
    check_stiffness(on_surface, x);
    check_bound(on_surface, x, thrice(node_areas(small)), 2);
    check_threads(more, random_vector(draws, 3 * large.n_nodes()));
    const ParameterMesh grid = parameter_grid(6, 8);
    const LoadedMembrane on_grid(grid, {0.4, 3, size});
    const VecX<double> y = random_vector(draws, 3 * grid.n_nodes);
    check_slopes(on_grid, y, 0.1);
    check_stiffness(on_grid, y);
    check_bound(on_grid, y, thrice(parameter_masses(grid, 1)), 2);
    // A translation d has no gradient, so that its energy is w0/2 times the integral of |d|^2 over u and v.
    const double cost = LoadedMembrane(grid, {0.4, 3, size}).energy(VecX<double>::Ones(y.size()));
    CHECK(cost == Approx(0.5 * 0.4 * 3 * 2 * kPi * kPi).epsilon(1e-12));
  }
}

TEST_CASE("loaded membrane: invalid weights and meshes are refused", "[local]") {
  ParameterMesh grid = parameter_grid(3, 4);
  CHECK_THROWS_WITH(LoadedMembrane(grid, {-1, 1}), has_text("w0"));
  grid.uv.col(3) = grid.uv.col(4);
  CHECK_THROWS_WITH(LoadedMembrane(grid, {1, 1}), has_text("triangle 1 of the parameter mesh has no area"));
  grid.triangles(2, 5) = 99;
  CHECK_THROWS_WITH(LoadedMembrane(grid, {1, 1}), has_text("refers to node 99"));
}

}  // namespace loaded_membrane_test
