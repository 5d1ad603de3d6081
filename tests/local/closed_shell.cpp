// Free vibration of a closed spherical shell against the exact spectrum of its membrane (Lamb 1882, Baker
// 1961).
#include <pliant/local/linear_membrane.h>

#include "catch.h"
#include "modes.h"

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

/// Omega of degree n on the mesh: root of the mean of the 2n + 1 values nearest to the exact one.
double discrete(const ShellMesh& mesh, int n, double nu) {
  const LinearMembrane membrane(mesh, {kE, nu, kThickness});
  const VecX<double> M = kDensity * kThickness * thrice(sphere_areas(mesh));
  const double exact = membrane_value(n, nu) * unit(nu);
  VecX<double> values =
      ritz_values(stiffness(membrane, VecX<double>::Zero(M.size())), M, exact, harmonic_fields(mesh, n), 3);
  std::sort(values.begin(), values.end(),
            [&](double a, double b) { return std::abs(a - exact) < std::abs(b - exact); });
  return std::sqrt(values.head(2 * n + 1).mean() / unit(nu));
}

}  // namespace

TEST_CASE("closed shell: the membrane's spectrum on 642 nodes", "[local]") {
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
