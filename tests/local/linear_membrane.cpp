// The linear membrane: its energy is exact for constant strain and zero for small rotations. It passes the
// checks of energy_laws.h.
#include <pliant/local/shell/linear_membrane.h>

#include <Eigen/SparseCholesky>

#include "catch.h"
#include "energy_laws.h"
#include "shell_meshes.h"

namespace linear_membrane_test {

using namespace pliant;
using namespace pliant::test;

namespace {

constexpr Sheet kSheet{7e4, 0.3, 0.02};  // E (Pa), nu, thickness (m)

/// Returns the largest |component| of the forces f at the inner nodes of a sheet a x b.
double inside(const ShellMesh& mesh, const VecX<double>& f, double a, double b) {
  const Eigen::Index n = mesh.n_nodes();
  double largest = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    if (std::abs(mesh.X()(i, 0)) < 0.499 * a && std::abs(mesh.X()(i, 1)) < 0.499 * b)
      for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(f[c * n + i]));
  return largest;
}

}  // namespace

TEST_CASE("linear membrane: constant strain is exact on irregular meshes", "[local]") {
  Draws draws(1);
  const ShellMesh mesh = irregular_sheet(7, 5, 2, 1.5, draws);
  for (const double nu : {-0.5, 0.0, 0.3, 0.5}) {
    const Sheet sheet{7e4, nu, 0.02};
    const LinearMembrane membrane(mesh, sheet);
    const double xx = 1e-3, yy = -4e-4, xy = 7e-4;
    const VecX<double> d = field(mesh, [&](const Vec3<double>& X) {
      return Vec3<double>(xx * X[0] + 1.5 * xy * X[1], 0.5 * xy * X[0] + yy * X[1], 0.1 * X[0]);
    });
    const double density = sheet.E * sheet.thickness / (2 * (1 - nu * nu)) *
                           (xx * xx + yy * yy + 2 * nu * xx * yy + 2 * (1 - nu) * xy * xy);
    CHECK(membrane.energy(d) == Approx(density * 2 * 1.5).epsilon(1e-13));
    const VecX<double> f = force(membrane, d);
    CHECK(inside(mesh, f, 2, 1.5) <= 1e-13 * f.lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("linear membrane: small rigid motions cause no strain on a curved mesh", "[local]") {
  const ShellMesh mesh = icosphere(2, 0.7);
  const LinearMembrane membrane(mesh, kSheet);
  const Vec3<double> c(0.3, -0.2, 0.1), w(0.4, 0.1, -0.5);
  const VecX<double> rigid =
      field(mesh, [&](const Vec3<double>& X) -> Vec3<double> { return c + w.cross(X); });
  Draws draws(2);
  const VecX<double> other = random_vector(draws, rigid.size());
  CHECK(force(membrane, rigid).norm() <= 1e-14 * force(membrane, other).norm());
  CHECK(membrane.energy(VecX<double>::Zero(rigid.size())) == 0);
}

TEST_CASE("linear membrane: derivatives, matrix, threads, frequency bound", "[local]") {
  Draws draws(3);
  const ShellMesh small = icosphere(1, 0.7), large = icosphere(4, 0.7);
  const LinearMembrane membrane(small, kSheet), more(large, kSheet);
  const VecX<double> x = random_vector(draws, 3 * small.n_nodes());
  check_slopes(membrane, x, 0.1);
  check_stiffness(membrane, x);
  check_bound(membrane, x, thrice(node_areas(small)), 1.5);
  check_bound(membrane, x, random_vector(draws, x.size()).cwiseAbs2(), 3);
  check_threads(more, random_vector(draws, 3 * large.n_nodes()));
}

TEST_CASE("linear membrane: invalid sheets and meshes are refused", "[local]") {
  const ShellMesh mesh = icosphere(0, 1);
  CHECK_THROWS_WITH(LinearMembrane(mesh, Sheet{1, 0.6, 1}), has_text("Poisson"));
  CHECK_THROWS_WITH(LinearMembrane(mesh, Sheet{1, -1, 1}), has_text("Poisson"));
  CHECK_THROWS_WITH(LinearMembrane(mesh, Sheet{-1, 0, 1}), has_text("Young"));
  CHECK_THROWS_WITH(LinearMembrane(mesh, Sheet{1, 0, 0}), has_text("thickness"));
  CHECK_THROWS_WITH(shell_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), has_text("triangle 0"));
  CHECK_THROWS_WITH(shell_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}}),
                    has_text("triangle 1 of the shell refers to node 3"));
  CHECK_THROWS_WITH(shell_mesh({{0, 0, 0}, {1, 0, 0}, {0, std::nan(""), 0}}, {{0, 1, 2}}),
                    has_text("node 2"));
}

}  // namespace linear_membrane_test
