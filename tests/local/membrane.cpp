// Membranes for large deformations: their energies against the continuum, rigid motion, the limit of small
// strain, and the checks of energy_laws.h.
#include <pliant/local/shell/membrane.h>

#include <pliant/local/shell/linear_membrane.h>

#include "catch.h"
#include "energy_laws.h"
#include "shell_meshes.h"

namespace membrane_test {

using namespace pliant;
using namespace pliant::test;

namespace {

VecX<double> rest(const ShellMesh& mesh) {
  return field(mesh, [](const Vec3<double>& X) { return X; });
}
VecX<double> rotated_sheet(const ShellMesh& mesh) {
  const Mat3<double> R = Eigen::AngleAxisd(2.1, Vec3<double>(1, -2, 0.5).normalized()).toRotationMatrix();
  return field(mesh, [&](const Vec3<double>& X) -> Vec3<double> { return Vec3<double>(3, 4, 5) + R * X; });
}

template <class Law>
void check_laws(double nu) {
  INFO(Law::name << ", nu = " << nu);
  const Sheet sheet{7e4, nu, 0.02};
  Draws draws(3);
  const ShellMesh small = icosphere(1, 0.7), large = icosphere(4, 0.7);
  const Membrane<Law> membrane(small, sheet), more(large, sheet);
  const VecX<double> X = rest(small), x = X + random_vector(draws, X.size(), 0.06);
  CHECK(membrane.energy(X) == 0);
  CHECK(force(membrane, X).norm() <= 1e-13 * force(membrane, x).norm());
  CHECK(membrane.energy(rotated_sheet(small)) <= 1e-13 * membrane.energy(x));
  CHECK(force(membrane, rotated_sheet(small)).norm() <= 1e-13 * force(membrane, x).norm());
  check_slopes(membrane, x, 2e-3);
  check_stiffness(membrane, x);
  const VecX<double> M = thrice(node_areas(small));
  check_bound(membrane, X, M, 2);
  check_bound(membrane, x, M, 2);
  check_threads(more, rest(large) + random_vector(draws, 3 * large.n_nodes(), 0.005));
  // At rest, the derivative of the force is that of the linear membrane.
  const VecX<double> dx = random_vector(draws, X.size());
  const VecX<double> linear = force(LinearMembrane(small, sheet), dx);
  CHECK((derivative(membrane, X, dx) - linear).norm() <= 1e-12 * linear.norm());
}

}  // namespace

TEST_CASE("membranes: derivatives, matrix, threads, frequency bound, rest and rigid motion", "[local]") {
  for (const double nu : {-0.4, 0.0, 0.3, 0.5}) {
    check_laws<StVenantKirchhoffSheet>(nu);
    check_laws<NeoHookeanSheet>(nu);
    if (nu >= 0) check_laws<NeoHookeanLogSheet>(nu);
  }
}

TEST_CASE("membranes: homogeneous stretch has the energy and the stress of the continuum", "[local]") {
  Draws draws(4);
  const ShellMesh mesh = irregular_sheet(6, 5, 1, 1, draws);
  const double E = 1e5, t = 0.01, l1 = 1.8, l2 = 0.7;
  const Mat3<double> R = Eigen::AngleAxisd(0.9, Vec3<double>(0.3, 1, 0.2).normalized()).toRotationMatrix();
  const auto stretched = [&](double a, double b) {
    return field(
        mesh, [&](const Vec3<double>& X) -> Vec3<double> { return R * Vec3<double>(a * X[0], b * X[1], 0); });
  };
  for (const double nu : {0.0, 0.3, 0.5}) {
    const Sheet sheet{E, nu, t};
    const double e1 = 0.5 * (l1 * l1 - 1), e2 = 0.5 * (l2 * l2 - 1);
    CHECK(StVenantKirchhoffMembrane(mesh, sheet).energy(stretched(l1, l2)) ==
          Approx(E * t / (2 * (1 - nu * nu)) * (e1 * e1 + e2 * e2 + 2 * nu * e1 * e2)).epsilon(1e-12));
    // The three-dimensional energy, minimised over the stretch l3 of the thickness.
    const double mu = E / (2 * (1 + nu)), beta = nu < 0.5 ? nu / (1 - 2 * nu) : 0;
    auto density = [&](double l3) {
      const double sum = l1 * l1 + l2 * l2 + l3 * l3 - 3, J = l1 * l2 * l3;
      return 0.5 * mu * (sum + (beta > 0 ? (std::pow(J, -2 * beta) - 1) / beta : -2 * std::log(J)));
    };
    double low = 0.2, high = 3;
    for (int i = 0; i < 200; ++i) {
      const double a = low + (high - low) / 3, b = high - (high - low) / 3;
      (density(a) < density(b) ? high : low) = density(a) < density(b) ? b : a;
    }
    // For the law with ln J, mu (l3^2 - 1) + lambda ln J = 0.
    const double lambda = nu < 0.5 ? E * nu / ((1 + nu) * (1 - 2 * nu)) : 0;
    double h = 1;
    for (int i = 0; nu < 0.5 && i < 60; ++i)
      h -= (mu * (h * h - 1) + lambda * std::log(l1 * l2 * h)) / (2 * mu * h + lambda / h);
    if (nu == 0.5) h = 1 / (l1 * l2);
    const double log_J = std::log(l1 * l2 * h), sum = l1 * l1 + l2 * l2 + h * h - 3;
    CHECK(NeoHookeanLogMembrane(mesh, sheet).energy(stretched(l1, l2)) ==
          Approx(t * (mu / 2 * sum - mu * log_J + lambda / 2 * log_J * log_J)).epsilon(1e-12));
    const double l3 = 1 / (l1 * l2);
    const double expected = nu < 0.5 ? density(low) : 0.5 * mu * (l1 * l1 + l2 * l2 + l3 * l3 - 3);
    CHECK(NeoHookeanMembrane(mesh, sheet).energy(stretched(l1, l2)) == Approx(t * expected).epsilon(1e-10));
  }
}

TEST_CASE("membranes: homogeneous strain exerts no force on inner nodes", "[local]") {
  Draws draws(5);
  const ShellMesh mesh = irregular_sheet(6, 5, 1, 1, draws);
  const VecX<double> x = field(mesh, [](const Vec3<double>& X) {
    return Vec3<double>(1.3 * X[0] + 0.2 * X[1], -0.1 * X[0] + 0.8 * X[1], 0.5 * X[0]);
  });
  auto check = [&](const NodalEnergy& membrane) {
    const VecX<double> f = force(membrane, x);
    const Eigen::Index n = mesh.n_nodes();
    for (Eigen::Index i = 0; i < n; ++i)
      if (mesh.X().row(i).cwiseAbs().maxCoeff() < 0.499)
        for (int c = 0; c < 3; ++c) CHECK(std::abs(f[c * n + i]) <= 1e-13 * f.lpNorm<Eigen::Infinity>());
  };
  check(StVenantKirchhoffMembrane(mesh, {1e5, 0.3, 0.01}));
  check(NeoHookeanMembrane(mesh, {1e5, 0.3, 0.01}));
  check(NeoHookeanLogMembrane(mesh, {1e5, 0.3, 0.01}));
}

TEST_CASE(
    "membranes: neo_hookean_log_membrane has uniaxial tension in closed form, and refuses flat triangles",
    "[local]") {
  // The stretch across the tension and that of the thickness are both a: mu (a^2 - 1) + lambda ln(a^2 s) = 0,
  // and the force per width is t mu (s - a^2/s).
  Draws draws(6);
  const double E = 1e5, nu = 0.4, t = 0.01, mu = E / (2 * (1 + nu)),
               lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  const ShellMesh mesh = irregular_sheet(4, 4, 1, 1, draws);
  const NeoHookeanLogMembrane membrane(mesh, {E, nu, t});
  for (const double s : {0.5, 1.2, 3.0}) {
    double a = 1;
    for (int i = 0; i < 60; ++i)
      a -= (mu * (a * a - 1) + lambda * std::log(a * a * s)) / (2 * mu * a + 2 * lambda / a);
    const auto stretched = [&](double along) {
      return membrane.energy(
          field(mesh, [&](const Vec3<double>& X) { return Vec3<double>(along * X[0], a * X[1], 0); }));
    };
    const double force =
        first_derivative([&](long double h) { return stretched(s + static_cast<double>(h)); }, 1e-3);
    CHECK(force == Approx(t * mu * (s - a * a / s)).epsilon(1e-9));
  }
  const VecX<double> flat = field(mesh, [](const Vec3<double>& X) { return Vec3<double>(X[0], 0, 0); });
  CHECK_THROWS_WITH(membrane.energy(flat), has_text("has no area"));
  CHECK_THROWS_AS(force(membrane, flat), InvertedElement);
  CHECK_THROWS_WITH(NeoHookeanLogMembrane(mesh, {E, -0.1, t}), has_text("negative Poisson's ratio"));
}

}  // namespace membrane_test
