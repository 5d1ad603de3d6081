// Pressure in closed shells: its resultant force and torque, the equilibrium of a rubber balloon, and checks
// of energy_laws.h.
#include <pliant/local/shell/pressure.h>

#include <pliant/local/shell/membrane.h>
#include <pliant/math/eigenvalues.h>

#include "catch.h"
#include "energy_laws.h"
#include "shell_meshes.h"

namespace pressure_test {

using namespace pliant;
using namespace pliant::test;

namespace {

VecX<double> rest(const ShellMesh& mesh) {
  return field(mesh, [](const Vec3<double>& X) { return X; });
}

/// Checks derivatives, threads, the stiffness matrix with its rank-one term, the frequency bound, and that
/// the resultant force and torque are zero.
void check_laws(const Pressure& pressure, const Pressure& more, const ShellMesh& small,
                const ShellMesh& large) {
  Draws draws(1);
  const VecX<double> x = rest(small) + random_vector(draws, 3 * small.n_nodes(), 0.05);
  check_slopes(pressure, x, 2e-3);
  check_threads(more, rest(large) + random_vector(draws, 3 * large.n_nodes(), 0.005));
  const VecX<double> w = pressure.rank_one(x), dx = random_vector(draws, x.size());
  const Eigen::SparseMatrix<double> sparse = stiffness(pressure, x);
  const VecX<double> K_dx = sparse * dx + w * w.dot(dx);
  CHECK((K_dx + derivative(pressure, x, dx)).norm() <= 1e-12 * K_dx.norm());
  const VecX<double> M = thrice(node_areas(small)), root = M.cwiseSqrt().cwiseInverse();
  const MatX<double> K = root.asDiagonal() * (MatX<double>(sparse) + w * w.transpose()) * root.asDiagonal();
  const double largest = symmetric_eigenvalues(K)[x.size() - 1];
  const double bound = pressure.frequency_bound(x, M);
  INFO("bound " << bound << ", largest " << largest);
  CHECK(bound >= largest);
  CHECK(bound <= 4 * largest);
  const VecX<double> f = force(pressure, x);
  const auto push = nodes(f, small.n_nodes()), at = nodes(x, small.n_nodes());
  Vec3<double> torque = Vec3<double>::Zero();
  for (Eigen::Index i = 0; i < small.n_nodes(); ++i)
    torque += Vec3<double>(at.row(i)).cross(Vec3<double>(push.row(i)));
  CHECK(push.colwise().sum().norm() <= 1e-13 * f.norm());
  CHECK(torque.norm() <= 1e-13 * f.norm());
}

}  // namespace

TEST_CASE("pressure: derivatives, matrix, threads, frequency bound, resultants", "[local]") {
  const ShellMesh small = icosphere(1, 0.7), large = icosphere(4, 0.7);
  const double V0 = ConstantPressure(small, 1).volume(rest(small));
  for (const double p : {300.0, -200.0})
    check_laws(ConstantPressure(small, p), ConstantPressure(large, p), small, large);
  for (const double gamma : {1.0, 1.4})
    for (const double p_ext : {0.0, 1.1e5}) {
      const Gas gas{1e5, 0.9 * V0, gamma, p_ext};
      check_laws(GasPressure(small, gas), GasPressure(large, gas), small, large);
    }
}

TEST_CASE("pressure: the volume does not depend on the position of the shell", "[local]") {
  const ShellMesh mesh = icosphere(3, 1);
  const ConstantPressure pressure(mesh, 1);
  const VecX<double> far =
      field(mesh, [](const Vec3<double>& X) -> Vec3<double> { return X + Vec3<double>(1e6, -2e6, 3e6); });
  CHECK(pressure.volume(rest(mesh)) == Approx(4 * kPi / 3).epsilon(0.01));
  CHECK(pressure.volume(far) == Approx(pressure.volume(rest(mesh))).epsilon(1e-9));
}

TEST_CASE("pressure: the equilibrium of a rubber balloon agrees with theory", "[local]") {
  // p = (2 t mu/r)(1/s - 1/s^7) at the stretch s of a neo-Hookean sphere.
  const double r = 0.5, t = 1e-3, E = 1e6, s = 1.3, mu = E / 3;
  const double p = 2 * t * mu / r * (1 / s - std::pow(s, -7));
  const auto error = [&](int levels) {
    const ShellMesh mesh = icosphere(levels, r);
    const VecX<double> x = s * rest(mesh);
    const VecX<double> pull = force(NeoHookeanMembrane(mesh, {E, 0.5, t}), x),
                       push = force(ConstantPressure(mesh, p), x);
    // The ratio of the virtual works of both forces in uniform growth of the sphere is -1 in equilibrium.
    return std::abs(pull.dot(x) / push.dot(x) + 1);
  };
  const double coarse = error(2), fine = error(3);
  INFO("errors " << coarse << ", " << fine);
  CHECK(fine <= 0.005);
  CHECK(std::log2(coarse / fine) >= 1.9);
}

TEST_CASE("pressure: open, inconsistently oriented and inverted shells are refused", "[local]") {
  const ShellMesh closed = icosphere(0, 1);
  const Eigen::Matrix3Xi triangles = closed.triangles();
  Eigen::Matrix3Xi one_turned = triangles, all_turned = triangles;
  one_turned.col(3).reverseInPlace();
  all_turned.row(0).swap(all_turned.row(1));
  CHECK_THROWS_WITH(ConstantPressure(ShellMesh(closed.X(), triangles.leftCols(19)), 1),
                    has_text("one triangle only"));
  CHECK_THROWS_WITH(ConstantPressure(ShellMesh(closed.X(), one_turned), 1), has_text("opposite orientation"));
  CHECK_THROWS_WITH(ConstantPressure(ShellMesh(closed.X(), all_turned), 1), has_text("enclose a volume"));
  CHECK_THROWS_WITH(GasPressure(closed, {1, 0, 1.4}), has_text("V0 > 0"));
}

}  // namespace pressure_test
