// Nearly incompressible solids: plain elements lock (are too stiff); elements with averaged dilatation do
// not.
// N22 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <cmath>
#include <memory>

#include <Eigen/Dense>

#include <pliant/local/solid/averaged_dilatation.h>
#include <pliant/local/solid/solid_mass.h>
#include <pliant/math/eigenvalues.h>

#include "solid_meshes.h"
#include "sparse_modes.h"

namespace nearly_incompressible_test {

using namespace pliant;
using test::Draws;
using test::SolidMesh;

namespace {

template <class Element>
SolidMesh sphere(int resolution) {
  return test::solid_mesh("sphere", {}, resolution, test::order_of(Element::n_nodes));
}

/// Returns omega r / c_t of the lowest spheroidal mode of degree 2 (0S2) of a free sphere. The result is the
/// first root of the frequency equation (Lamb 1882). r: radius; c_t: speed of shear waves.
double lamb_S2(double nu) {
  const double slow = std::sqrt((1 - 2 * nu) / (2 * (1 - nu)));
  auto j = [](unsigned l, double x) { return std::sph_bessel(l, x); };
  auto miss = [&](double y) {
    const double x = y * slow;
    return ((2 - y * y / 2) * j(2, x) + 2 * x * j(3, x)) * ((3 - y * y / 2) * j(2, y) + y * j(3, y)) -
           6 * (j(2, y) - y * j(3, y)) * (j(2, x) - x * j(3, x));
  };
  double low = 2.55, high = 2.75;
  while (high - low > 1e-13) {
    const double middle = (low + high) / 2;
    (miss(low) * miss(middle) <= 0 ? high : low) = middle;
  }
  return low;
}

/// Returns the largest relative error of the frequencies of the five lowest spheroidal modes of degree 2
/// (0S2). After the six rigid motions, the lowest modes are five torsional modes of degree 2 (T2), then 0S2.
template <class Element>
double S2_error(const NodalEnergy& energy, const SolidMesh& mesh, double nu) {
  const test::Sparse M = Element::n_nodes == 4
                             ? test::in_space(lumped_mass(mesh.rest, mesh.elements, 1))
                             : test::in_space(consistent_mass(mesh.rest, mesh.elements, 1), mesh.n());
  const VecX<double> eta =
      test::modes_near(test::stiffness_at(energy, VecX<double>::Zero(3 * mesh.n())), M, -2, 16, 6)
          .values.tail<10>()
          .cwiseSqrt();
  const double exact = lamb_S2(nu);
  return std::max(eta[9] / exact - 1, 1 - eta[5] / exact);
}
/// Returns S2_error() of plain elements.
template <class Element>
double plain_error(int resolution, double nu) {
  const SolidMesh mesh = sphere<Element>(resolution);
  return S2_error<Element>(
      LinearSolid<Element>(mesh.rest, mesh.elements, LinearLaw(Elasticity(2 * (1 + nu), nu))), mesh, nu);
}
/// Returns S2_error() of elements with averaged dilatation.
template <class Element>
double averaged_error(int resolution, double nu) {
  const SolidMesh mesh = sphere<Element>(resolution);
  return S2_error<Element>(
      AveragedLinearSolid<Element>(mesh.rest, mesh.elements, Elasticity(2 * (1 + nu), nu)), mesh, nu);
}

}  // namespace

TEMPLATE_TEST_CASE("averaged dilatation: force, energy, stiffness, rigid motion, threads, frequency bound",
                   "[solid]", LinearTetrahedron, QuadraticTetrahedron, EnrichedTetrahedron) {
  const SolidMesh mesh = sphere<TestType>(TestType::n_nodes == 4 ? 2 : 1);
  const Elasticity material(3, 0.48);
  const AveragedLinearSolid<TestType> energy(mesh.rest, mesh.elements, material);
  const LinearSolid<TestType> plain(mesh.rest, mesh.elements, LinearLaw(material));
  Draws draws(2);
  VecX<double> x(3 * mesh.n());
  for (double& value : x) value = draws.uniform(-1, 1);
  NodalEnergy::Buffer buffer;
  auto force = [&](const NodalEnergy& of, const VecX<double>& at, ThreadPool* pool) {
    VecX<double> f = VecX<double>::Zero(at.size());
    of.add_force(at, f, buffer, pool);
    return f;
  };
  const VecX<double> f = force(energy, x, nullptr);
  CHECK(energy.energy(x) == Approx(-0.5 * x.dot(f)).epsilon(1e-13));
  CHECK(energy.energy(x) < 0.9 * plain.energy(x));
  const MatX<double> K = test::stiffness_at(energy, x), K_plain = test::stiffness_at(plain, x);
  CHECK((K * x + f).norm() <= 1e-13 * f.norm());
  CHECK((K - K.transpose()).norm() <= 1e-14 * K.norm());
  // In no direction is the stiffness larger than that of plain elements.
  CHECK(symmetric_eigenvalues(K_plain - K).minCoeff() >= -1e-12 * K.norm());
  // A uniform strain has the energy of plain elements, and a small rigid motion causes no force.
  Mat3<double> A;
  A << 0.2, 0.1, -0.05, 0.03, -0.1, 0.08, -0.02, 0.12, 0.15;
  const VecX<double> uniform = test::affine(mesh.rest, A, {1, 2, 3});
  CHECK(energy.energy(uniform) == Approx(plain.energy(uniform)).epsilon(1e-13));
  const VecX<double> turn = test::affine(mesh.rest, skew(Vec3<double>(1, -2, 3)), {1, 2, 3});
  CHECK(force(energy, turn, nullptr).norm() <= 1e-13 * K.norm());
  const VecX<double> M = lumped_mass(mesh.rest, mesh.elements, 1).replicate(3, 1),
                     root = M.cwiseSqrt().cwiseInverse();
  CHECK(energy.frequency_bound(x, M) >=
        symmetric_eigenvalues(root.asDiagonal() * K * root.asDiagonal()).maxCoeff());

  const SolidMesh fine = sphere<TestType>(TestType::n_nodes == 4 ? 5 : 3);
  const AveragedLinearSolid<TestType> large(fine.rest, fine.elements, material);
  VecX<double> y(3 * fine.n());
  for (double& value : y) value = draws.uniform(-1, 1);
  const VecX<double> once = force(large, y, nullptr);
  for (int threads : {1, 2, 3}) {
    ThreadPool pool(threads);
    CHECK(force(large, y, &pool) == once);
  }
  CHECK_THROWS_WITH(AveragedLinearSolid<TestType>(mesh.rest, mesh.elements, Elasticity(1, -0.1)),
                    test::has_text("0.4999"));
}

TEMPLATE_TEST_CASE("averaged dilatation: a uniform strain gives equal stress in all elements", "[solid]",
                   LinearTetrahedron, QuadraticTetrahedron, EnrichedTetrahedron) {
  Mat3<double> A;
  A << 0.2, 0.1, -0.05, 0.03, -0.1, 0.08, -0.02, 0.12, 0.15;
  const SolidMesh box = test::crooked_box(TestType::n_nodes);
  for (const SolidMesh& mesh : {TestType::n_nodes == 15 ? test::without_bubbles(box) : box,
                                sphere<TestType>(TestType::n_nodes == 4 ? 2 : 1)})
    for (double nu : {0.3, 0.4999}) {
      const Elasticity material(3, nu);
      const AveragedLinearSolid<TestType> energy(mesh.rest, mesh.elements, material);
      const LinearSolid<TestType> plain(mesh.rest, mesh.elements, LinearLaw(material));
      const VecX<double> x = test::affine(mesh.rest, A, {1, 2, 3});
      NodalEnergy::Buffer buffer;
      VecX<double> f = VecX<double>::Zero(x.size()), f_plain = f;
      energy.add_force(x, f, buffer, nullptr);
      plain.add_force(x, f_plain, buffer, nullptr);
      CHECK(test::largest_inside(f, mesh) <= 1e-14 * f.norm());
      CHECK((f - f_plain).norm() <= 1e-13 * f.norm());
      double volume = 0;
      for (int e = 0; e < plain.n_elements(); ++e) volume += plain.volume(e);
      const Mat3<double> stress = nodes(f, mesh.n()).transpose() * mesh.rest;
      CHECK((stress + volume * plain.law().stress(A)).norm() <= 1e-13 * stress.norm());
    }
}

TEST_CASE("N22: a sphere of linear elements locks, with averaged dilatation it does not", "[solid][long]") {
  CHECK(lamb_S2(0.3) == Approx(2.64622).margin(1e-5));
  CHECK(lamb_S2(0.49) == Approx(2.66483).margin(1e-5));
  CHECK(plain_error<LinearTetrahedron>(4, 0.3) < 0.05);
  CHECK(plain_error<LinearTetrahedron>(4, 0.4999) > 0.1);
  for (double nu : {0.49, 0.499, 0.4999}) {
    INFO(nu);
    CHECK(averaged_error<LinearTetrahedron>(4, nu) < 0.05);
  }
}

TEST_CASE("N22: quadratic elements lock less, with averaged dilatation not at all", "[solid][long]") {
  CHECK(plain_error<QuadraticTetrahedron>(2, 0.49) < 0.01);
  CHECK(plain_error<QuadraticTetrahedron>(2, 0.4999) > 0.05);
  for (double nu : {0.49, 0.499, 0.4999}) {
    INFO(nu);
    CHECK(averaged_error<QuadraticTetrahedron>(2, nu) < 0.002);
  }
}

}  // namespace nearly_incompressible_test
