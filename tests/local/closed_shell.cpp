// Free vibration of a closed spherical shell against the exact spectrum of its membrane (Lamb 1882, Baker
// 1961).
#include <pliant/local/bending.h>
#include <pliant/local/linear_membrane.h>

#include "catch.h"
#include "modes.h"

namespace closed_shell_test {

using namespace pliant;
using namespace pliant::test;

namespace {

constexpr double kRadius = 2.5, kE = 2e11, kDensity = 7800, kThickness = 0.1;

/// Omega^2 = omega^2 r^2 rho (1 - nu^2)/E of the lower branch; n = 0: breathing.
double membrane_value(int n, double nu) {
  if (n == 0) return 2 * (1 + nu);
  const double b = n * n + n + 1 + 3 * nu;
  return 0.5 * (b - std::sqrt(b * b - 4 * (1 - nu * nu) * (n * n + n - 2)));
}

double unit(double nu) {
  return kE / (kRadius * kRadius * kDensity * (1 - nu * nu));
}

/// Fields of the degrees beside n.
MatX<double> neighbours(const ShellMesh& mesh, int n) {
  const MatX<double> above = harmonic_fields(mesh, n + 1), below = harmonic_fields(mesh, std::max(n - 1, 2));
  if (n <= 2) return above;
  MatX<double> both(above.rows(), above.cols() + below.cols());
  both << above, below;
  return both;
}

/// Omega of degree n on the mesh: root of the mean of its 2n + 1 values.
double discrete(const ShellMesh& mesh, int n, double nu) {
  const LinearMembrane membrane(mesh, {kE, nu, kThickness});
  const VecX<double> M = kDensity * kThickness * thrice(sphere_areas(mesh));
  const Eigen::SparseMatrix<double> K = stiffness(membrane, VecX<double>::Zero(M.size()));
  return std::sqrt(mean_of_modes(K, M, membrane_value(n, nu) * unit(nu), harmonic_fields(mesh, n),
                                 neighbours(mesh, n), 2 * n + 1) /
                   unit(nu));
}

/// Hz, of the shell that bends too.
constexpr std::array<double, 11> kBending{0,      0,      237.25, 282.85, 305.24, 324.17,
                                          346.76, 376.68, 416,    465.75, 526.20};

/// Frequency of degree n over the exact one, less 1.
double bending_error(int levels, int n) {
  const ShellMesh mesh = icosphere(levels, kRadius);
  const Sheet sheet{kE, 0.3, kThickness};
  const LinearMembrane membrane(mesh, sheet);
  const LinearBending bending(mesh, sheet, kDensity * kThickness);
  const Eigen::Index nodal = 3 * mesh.n_nodes(), all = nodal + bending.own_inertia().size();
  VecX<double> M(all);
  M << kDensity * kThickness * thrice(sphere_areas(mesh)), bending.own_inertia();
  const VecX<double> zero = VecX<double>::Zero(all);
  const Eigen::SparseMatrix<double> K = stiffness(membrane, zero) + stiffness(bending, zero);
  const double exact = std::pow(2 * kPi * kBending[static_cast<std::size_t>(n)], 2);
  const auto with_own = [&](const MatX<double>& fields) {
    MatX<double> U = MatX<double>::Zero(all, fields.cols());
    U.topRows(nodal) = fields;
    return U;
  };
  return std::sqrt(mean_of_modes(K, M, exact, with_own(harmonic_fields(mesh, n)),
                                 with_own(neighbours(mesh, n)), 2 * n + 1) /
                   exact) -
         1;
}

}  // namespace

TEST_CASE("closed shell: the membrane's spectrum on 642 nodes", "[local][long]") {
  const ShellMesh mesh = icosphere(3, kRadius);
  REQUIRE(mesh.n_nodes() == 642);
  for (const double nu : {0.0, 0.3, 0.5})
    for (const int n : {0, 2, 3, 4, 5, 6}) {
      const double exact = std::sqrt(membrane_value(n, nu)), omega = discrete(mesh, n, nu);
      INFO("nu " << nu << ", n " << n << ": " << omega << ", exact " << exact << ", error "
                 << omega / exact - 1);
      CHECK(std::abs(omega / exact - 1) <= (n <= 3 ? 0.003 : 0.01));
    }
  CHECK(std::sqrt(membrane_value(2, 0.3)) == Approx(0.70094).epsilon(1e-5));
}

TEST_CASE("closed shell: the membrane's spectrum converges with the square of the edge", "[local]") {
  const ShellMesh coarse = icosphere(2, kRadius), fine = icosphere(3, kRadius),
                  finest = icosphere(4, kRadius);
  for (const int n : {0, 2, 3}) {
    const double exact = std::sqrt(membrane_value(n, 0.3));
    const double a = std::abs(discrete(coarse, n, 0.3) / exact - 1),
                 b = std::abs(discrete(fine, n, 0.3) / exact - 1),
                 c = std::abs(discrete(finest, n, 0.3) / exact - 1);
    INFO("n " << n << ": errors " << a << ", " << b << ", " << c);
    CHECK(std::log2(a / b) >= 1.9);
    CHECK(std::log2(b / c) >= 1.9);
  }
}

TEST_CASE("closed shell: with bending, on 642 nodes", "[local][long]") {
  for (int n = 2; n <= 10; ++n) {
    const double coarse = bending_error(2, n), fine = bending_error(3, n);
    INFO("n " << n << ": errors " << coarse << ", " << fine);
    CHECK(std::abs(fine) <= 0.0015 * n * n);
  }
}

TEST_CASE("closed shell: with bending it converges with the square of the edge", "[local][long]") {
  for (const int n : {2, 4, 6, 8}) {
    const double coarse = bending_error(3, n), fine = bending_error(4, n);
    INFO("n " << n << ": errors " << coarse << ", " << fine);
    CHECK(std::abs(fine) <= 0.0003 * n * n);
    CHECK(std::log2(coarse / fine) >= 1.8);
  }
  CHECK(std::abs(bending_error(4, 10)) <= 0.04);
}

}  // namespace closed_shell_test
