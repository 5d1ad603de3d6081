// Checks of the energies of tetrahedra: forces, derivatives, stiffness, patch tests, rigid motion, threads,
// frequency bounds.
#include <pliant/local/solid/solid_energy.h>

#include <cmath>

#include <Eigen/Dense>

#include <pliant/local/solid/make_solid_energy.h>
#include <pliant/local/solid/solid_mass.h>
#include <pliant/math/eigenvalues.h>

#include "catch.h"
#include "draws.h"
#include "solid_meshes.h"
#include "worst.h"

namespace solid_energy_test {

using namespace pliant;
using test::affine;
using test::crooked_box;
using test::Draws;
using test::largest_inside;
using test::SolidMesh;

namespace {

const Elasticity kRubber(3.0, 0.3);  // E (Pa), nu

SolidMesh ball(int n_nodes) {
  return test::solid_mesh("sphere", {}, n_nodes == 4 ? 2 : 1, test::order_of(n_nodes));
}

template <class Element, class Law>
struct Kind {
  using Energy = SolidEnergy<Element, Law>;
  using Shape = Element;
  static constexpr int N = Element::n_nodes;
  static constexpr bool linear = Law::of == NodalEnergy::Of::displacement;
  static Energy make(const SolidMesh& mesh) { return Energy(mesh.rest, mesh.elements, Law(kRubber)); }
  static constexpr bool kRefusesInversion =
      std::is_same_v<Law, Corotated> || std::is_same_v<Law, NeoHookeanLog>;
  /// Largest random displacement. It causes strains of some tenths and may invert elements. It is smaller for
  /// elements of 15 nodes with laws that refuse inverted elements.
  static constexpr double kSize = N == 15 && kRefusesInversion ? 0.01 : 0.05;
  static VecX<double> state(const SolidMesh& mesh, double size = kSize) {
    Draws draws(3);
    VecX<double> x = affine(mesh.rest, linear ? Mat3<double>::Zero().eval() : Mat3<double>::Identity().eval(),
                            Vec3<double>::Zero());
    for (double& value : x) value += draws.uniform(-size, size);
    return x;
  }
  static VecX<double> direction(const SolidMesh& mesh) {
    Draws draws(8);
    VecX<double> dx(3 * mesh.n());
    for (double& value : dx) value = draws.uniform(-1, 1);
    return dx;
  }
};

template <class Energy>
VecX<double> force(const Energy& energy, const VecX<double>& x, ThreadPool* pool = nullptr) {
  NodalEnergy::Buffer buffer;
  VecX<double> f = VecX<double>::Zero(x.size());
  energy.add_force(x, f, buffer, pool);
  return f;
}
template <class Energy>
VecX<double> derivative(const Energy& energy, const VecX<double>& x, const VecX<double>& dx,
                        ThreadPool* pool = nullptr) {
  NodalEnergy::Buffer buffer;
  VecX<double> f = VecX<double>::Zero(x.size());
  energy.add_derivative(x, dx, f, buffer, pool);
  return f;
}
template <class Energy>
MatX<double> stiffness(const Energy& energy, const VecX<double>& x) {
  std::vector<Eigen::Triplet<double>> entries;
  energy.add_stiffness(x, entries);
  MatX<double> K = MatX<double>::Zero(x.size(), x.size());
  for (const auto& entry : entries) K(entry.row(), entry.col()) += entry.value();
  return K;
}
/// Returns the derivative of f at 0 by the fourth-order central difference with the step h.
template <class F>
auto difference(F&& f, double h) -> decltype(f(h)) {
  return ((8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h));
}
/// Returns a uniform displacement gradient with components of up to 0.2.
Mat3<double> uniform_strain() {
  Mat3<double> A;
  A << 0.2, 0.1, -0.05, 0.03, -0.1, 0.08, -0.02, 0.12, 0.15;
  return A;
}
/// Returns the largest eigenvalue omega^2 of K u = omega^2 M u, 1/s^2. M: diagonal of the mass matrix, kg.
double largest_frequency(const MatX<double>& K, const VecX<double>& M) {
  const VecX<double> root = M.cwiseSqrt().cwiseInverse();
  const MatX<double> A = root.asDiagonal() * K * root.asDiagonal();
  return symmetric_eigenvalues(A).maxCoeff();
}

}  // namespace

#define PLIANT_ALL_KINDS                                                                         \
  (Kind<LinearTetrahedron, LinearLaw>), (Kind<LinearTetrahedron, StVenantKirchhoff>),            \
      (Kind<LinearTetrahedron, NeoHookean>), (Kind<LinearTetrahedron, Corotated>),               \
      (Kind<LinearTetrahedron, NeoHookeanLog>), (Kind<QuadraticTetrahedron, NeoHookeanLog>),     \
      (Kind<EnrichedTetrahedron, NeoHookeanLog>), (Kind<QuadraticTetrahedron, LinearLaw>),       \
      (Kind<QuadraticTetrahedron, StVenantKirchhoff>), (Kind<QuadraticTetrahedron, NeoHookean>), \
      (Kind<QuadraticTetrahedron, Corotated>), (Kind<EnrichedTetrahedron, LinearLaw>),           \
      (Kind<EnrichedTetrahedron, StVenantKirchhoff>), (Kind<EnrichedTetrahedron, NeoHookean>),   \
      (Kind<EnrichedTetrahedron, Corotated>)

TEMPLATE_TEST_CASE("forces are minus the gradients of the energy, derivatives are those of the forces",
                   "[solid]", PLIANT_ALL_KINDS) {
  const SolidMesh mesh = crooked_box(TestType::N);
  const auto energy = TestType::make(mesh);
  const VecX<double> x = TestType::state(mesh), dx = TestType::direction(mesh);
  const VecX<double> f = force(energy, x), df = derivative(energy, x, dx);
  const double slope = difference([&](double h) { return energy.energy(x + h * dx); }, 1e-4);
  CHECK(slope == Approx(-f.dot(dx)).epsilon(1e-9));
  const VecX<double> change =
      difference([&](double h) -> VecX<double> { return force(energy, x + h * dx); }, 1e-4);
  CHECK((change - df).norm() <= 1e-9 * df.norm());
  CHECK(energy.energy(x) > 0);
}

TEMPLATE_TEST_CASE("the assembled stiffness is minus the derivative of the forces, and symmetric", "[solid]",
                   PLIANT_ALL_KINDS) {
  const SolidMesh mesh = crooked_box(TestType::N);
  const auto energy = TestType::make(mesh);
  const VecX<double> x = TestType::state(mesh), dx = TestType::direction(mesh);
  const MatX<double> K = stiffness(energy, x);
  CHECK((K * dx + derivative(energy, x, dx)).norm() <= 1e-13 * (K * dx).norm());
  CHECK((K - K.transpose()).norm() <= 1e-14 * K.norm());
  if (TestType::linear) CHECK((K * x + force(energy, x)).norm() <= 1e-13 * (K * x).norm());
}

TEMPLATE_TEST_CASE("at rest every law has the stiffness of linear elasticity", "[solid]", PLIANT_ALL_KINDS) {
  const SolidMesh mesh = crooked_box(TestType::N);
  using Linear = Kind<typename TestType::Shape, LinearLaw>;
  const VecX<double> rest = TestType::state(mesh, 0);
  const MatX<double> K = stiffness(TestType::make(mesh), rest);
  const MatX<double> linear = stiffness(Linear::make(mesh), Linear::state(mesh, 0));
  CHECK((K - linear).norm() <= 1e-13 * linear.norm());
  CHECK(force(TestType::make(mesh), rest).norm() <= 1e-13 * linear.norm());
}

TEMPLATE_TEST_CASE("a uniform strain gives equal stress in all elements", "[solid]", PLIANT_ALL_KINDS) {
  Mat3<double> A = uniform_strain();
  if (!TestType::linear) A += Mat3<double>::Identity();
  const SolidMesh box = crooked_box(TestType::N);
  for (const SolidMesh& mesh : {TestType::N == 15 ? test::without_bubbles(box) : box, ball(TestType::N)}) {
    const auto energy = TestType::make(mesh);
    const VecX<double> x = affine(mesh.rest, A, {0.3, -0.2, 0.1});
    const VecX<double> f = force(energy, x);
    CHECK(largest_inside(f, mesh) <= 1e-14 * f.norm());
    double volume = 0;
    for (int e = 0; e < energy.n_elements(); ++e) volume += energy.volume(e);
    CHECK(energy.energy(x) == Approx(volume * energy.law().density(A)).epsilon(1e-13));
    // Virtual work of the boundary: the sum of f_a X_a^T over the nodes a is -V P, with the volume V and the
    // stress P.
    const Mat3<double> stress = nodes(f, mesh.n()).transpose() * mesh.rest;
    CHECK((stress + volume * energy.law().stress(A)).norm() <= 1e-13 * stress.norm());
  }
}

TEST_CASE(
    "elements of 15 nodes balance a uniform stress to rounding, unless taper and bend deform the rest shape",
    "[solid]") {
  // An element has a bubble at a face or middle node that is not at the quadratic interpolation of its other
  // nodes. Without bubbles the force on a node is an integral of degree 3, for which the rule of degree 5 is
  // exact. A bubble on the boundary adds nothing, by the symmetry of the rule. In the undeformed shape Solid
  // places inner face and middle nodes without bubbles; taper and bend create bubbles, so that the integrand
  // has degree 7.
  auto residual = [](const SolidMesh& mesh) {
    using Linear = Kind<EnrichedTetrahedron, LinearLaw>;
    const VecX<double> f = force(Linear::make(mesh), affine(mesh.rest, uniform_strain(), {0, 0, 0}));
    return largest_inside(f, mesh) / f.norm();
  };
  auto box = [](int resolution, bool deformed) {
    return deformed
               ? test::solid_mesh("box", {{"a1", 0.7}, {"a3", 1.4}, {"taper.tx", 0.2}, {"bend.angle", 0.4}},
                                  resolution, Solid::Order::enriched, {"taper", "bend"})
               : test::solid_mesh("box", {{"a1", 0.7}, {"a3", 1.4}}, resolution, Solid::Order::enriched);
  };
  CHECK(residual(box(2, false)) <= 1e-14);
  const double coarse = residual(box(1, true)), middle = residual(box(2, true)),
               fine = residual(box(4, true));
  INFO(coarse << ", " << middle << ", " << fine);
  CHECK(coarse <= 3.2e-6);
  CHECK(middle <= 1.9e-7);
  CHECK(fine <= 1.5e-8);
  CHECK(std::log2(coarse / middle) >= 3.5);
  CHECK(std::log2(middle / fine) >= 3.5);
}

TEMPLATE_TEST_CASE("rigid motion causes no strain", "[solid]", PLIANT_ALL_KINDS) {
  const SolidMesh mesh = crooked_box(TestType::N);
  const auto energy = TestType::make(mesh);
  const double scale = stiffness(energy, TestType::state(mesh, 0)).norm();
  const Mat3<double> rotation =
      TestType::linear ? skew(Vec3<double>(0.3, -0.5, 0.8))
                       : Eigen::AngleAxisd(2.4, Vec3<double>(1, 2, -1).normalized()).toRotationMatrix();
  const VecX<double> x = affine(mesh.rest, rotation, {3, 1, -2});
  CHECK(force(energy, x).norm() <= 1e-13 * scale);
  CHECK(std::abs(energy.energy(x)) <= 1e-13 * scale);
  // The internal forces have no resultant force or torque in any deformed state.
  const VecX<double> deformed = TestType::state(mesh), f = force(energy, deformed);
  CHECK(nodes(f, mesh.n()).colwise().sum().norm() <= 1e-13 * f.norm());
  Vec3<double> torque = Vec3<double>::Zero();
  for (int i = 0; i < mesh.n(); ++i) {
    Vec3<double> at = mesh.rest.row(i);
    if (!TestType::linear) at = nodes(deformed, mesh.n()).row(i);
    torque += at.cross(Vec3<double>(nodes(f, mesh.n()).row(i)));
  }
  CHECK(torque.norm() <= 1e-12 * f.norm());
}

TEMPLATE_TEST_CASE("identical bits for any number of threads", "[solid]", PLIANT_ALL_KINDS) {
  const SolidMesh mesh =
      test::solid_mesh("sphere", {}, TestType::N == 4 ? 5 : 3, test::order_of(TestType::N));
  const auto energy = TestType::make(mesh);
  const VecX<double> x = TestType::state(mesh, 0.01), dx = TestType::direction(mesh);
  const VecX<double> f = force(energy, x), df = derivative(energy, x, dx);
  for (int threads : {1, 2, 3}) {
    ThreadPool pool(threads);
    CHECK(force(energy, x, &pool) == f);
    CHECK(derivative(energy, x, dx, &pool) == df);
  }
}

TEMPLATE_TEST_CASE("the frequency bound is valid, and close", "[solid]", PLIANT_ALL_KINDS) {
  for (const SolidMesh& mesh : {crooked_box(TestType::N), ball(TestType::N)}) {
    const auto energy = TestType::make(mesh);
    const VecX<double> M = lumped_mass(mesh.rest, mesh.elements, 2.5).replicate(3, 1);
    for (double size : {0.0, 0.03}) {
      const VecX<double> x = TestType::state(mesh, size);
      const double exact = largest_frequency(stiffness(energy, x), M), bound = energy.frequency_bound(x, M);
      CHECK(bound >= exact);
      CHECK(bound <= 4 * exact);
    }
    VecX<double> massless = M;
    massless[7] = 0;
    CHECK(energy.frequency_bound(TestType::state(mesh, 0), massless) == kInfinity);
  }
}

TEST_CASE("inverted elements are refused, or pushed back", "[solid]") {
  const SolidMesh mesh = ball(4);
  Mat3<double> mirror = Mat3<double>::Identity();
  mirror(2, 2) = -0.5;
  const VecX<double> x = affine(mesh.rest, mirror, Vec3<double>::Zero());
  const auto corotated = Kind<LinearTetrahedron, Corotated>::make(mesh);
  CHECK_THROWS_AS(force(corotated, x), InvertedElement);
  CHECK_THROWS_WITH(force(corotated, x), test::has_text("inverted"));
  ThreadPool pool(2);
  CHECK_THROWS_AS(force(corotated, x, &pool), InvertedElement);
  const auto neo_hookean = Kind<LinearTetrahedron, NeoHookean>::make(mesh);
  const VecX<double> f = force(neo_hookean, x);
  // The node that is at the top at rest is now at the bottom. The force on it points up, to its place at
  // rest.
  Eigen::Index top = 0;
  mesh.rest.col(2).maxCoeff(&top);
  CHECK(f.allFinite());
  CHECK(nodes(f, mesh.n())(top, 2) > 0);
  mirror(2, 2) = -1;
  CHECK(neo_hookean.energy(affine(mesh.rest, mirror, Vec3<double>::Zero())) > neo_hookean.energy(x));
}

TEST_CASE("neo_hookean_log has infinite energy where det F reaches 0, and refuses inverted elements",
          "[solid]") {
  const NeoHookeanLog law(kRubber);
  double before = 0;
  for (const double J : {1e-1, 1e-4, 1e-16, 1e-300}) {
    const double W = law.density(Mat3<double>(Vec3<double>(1, 1, J).asDiagonal()));
    CHECK(W > before);
    before = W;
  }
  for (const double J : {0.0, -0.5})
    CHECK_THROWS_AS(law.density(Mat3<double>(Vec3<double>(1, 1, J).asDiagonal())), InvertedElement);
  const SolidMesh mesh = ball(4);
  const auto energy = Kind<LinearTetrahedron, NeoHookeanLog>::make(mesh);
  const VecX<double> x = affine(mesh.rest, Vec3<double>(1, 1, -0.5).asDiagonal(), Vec3<double>::Zero());
  CHECK_THROWS_WITH(force(energy, x), test::has_text("is inverted or flat (det F = -0.5)"));
  CHECK_THROWS_AS(energy.energy(x), InvertedElement);
  CHECK_THROWS_WITH(NeoHookeanLog(Elasticity(3, -0.1)), test::has_text("negative Poisson's ratio"));
}

TEST_CASE("rubber in uniaxial tension: closed forms of both neo-Hookean laws", "[solid]") {
  // F = diag(a, a, s) with no stress across: the nominal stress P_33 as a function of the stretch s.
  const double lambda = kRubber.lambda(), mu = kRubber.mu();
  const auto stretched = [](double a, double s) { return Mat3<double>(Vec3<double>(a, a, s).asDiagonal()); };
  for (const double s : {0.3, 0.8, 1.0, 1.5, 4.0}) {
    // Law with ln J: mu (a^2 - 1) + lambda ln J = 0 and P_33 = mu (s - a^2/s), J = a^2 s.
    double a = 1;
    for (int i = 0; i < 60; ++i)
      a -= (mu * (a * a - 1) + lambda * std::log(a * a * s)) / (2 * mu * a + 2 * lambda / a);
    const Mat3<double> P = NeoHookeanLog(kRubber).stress(stretched(a, s));
    CHECK(std::abs(P(0, 0)) <= 1e-14 * mu * (1 + s));
    CHECK(P(2, 2) == Approx(mu * (s - a * a / s)).epsilon(1e-13).margin(1e-14));
    // Law without logarithm: mu a + q a s = 0 with q = (lambda + mu)(J - 1) - mu, so q = -mu/s, J - 1 = (mu -
    // mu/s)/ (lambda + mu) and P_33 = mu s + q a^2.
    const double J = 1 + (mu - mu / s) / (lambda + mu);
    if (J <= 0) continue;
    const Mat3<double> smooth = NeoHookean(kRubber).stress(stretched(std::sqrt(J / s), s));
    CHECK(std::abs(smooth(0, 0)) <= 1e-14 * mu * (1 + s));
    CHECK(smooth(2, 2) == Approx(mu * (s - J / (s * s))).epsilon(1e-13).margin(1e-14));
  }
}

TEST_CASE("the nearest rotation of strong deformations", "[solid]") {
  Draws draws(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Mat3<double> R =
        Eigen::AngleAxisd(draws.uniform(-kPi, kPi), draws.vector(1).normalized()).toRotationMatrix();
    const Mat3<double> Q =
        Eigen::AngleAxisd(draws.uniform(-kPi, kPi), draws.vector(1).normalized()).toRotationMatrix();
    const Vec3<double> stretch{std::exp(draws.uniform(-3, 3)), std::exp(draws.uniform(-3, 3)),
                               std::exp(draws.uniform(-3, 3))};
    const Mat3<double> F = R * Q * stretch.asDiagonal() * Q.transpose();
    CHECK((nearest_rotation(F) - R).norm() <= 1e-12);
  }
}

TEST_CASE("invalid materials and elements are refused", "[solid]") {
  CHECK_THROWS_WITH(Elasticity(0, 0.3), test::has_text("must be positive and finite"));
  CHECK_THROWS_WITH(Elasticity(kInfinity, 0.3), test::has_text("must be positive and finite"));
  CHECK_THROWS_WITH(Elasticity(1, 0.5), test::has_text("averaged dilatation"));
  CHECK_THROWS_WITH(Elasticity(1, 0.51), test::has_text("below 0.5"));
  CHECK_THROWS_WITH(Elasticity(1, -1), test::has_text("above -1"));
  SolidMesh mesh = ball(4);
  CHECK_THROWS_WITH(LinearSolid<QuadraticTetrahedron>(mesh.rest, mesh.elements, LinearLaw(kRubber)),
                    test::has_text("10 nodes"));
  mesh.elements(2, 3) += mesh.n();
  CHECK_THROWS_WITH(LinearSolid<LinearTetrahedron>(mesh.rest, mesh.elements, LinearLaw(kRubber)),
                    test::has_text("the mesh has nodes 0 to"));
  mesh.elements(2, 3) -= mesh.n();
  std::swap(mesh.elements(0, 5), mesh.elements(1, 5));
  CHECK_THROWS_WITH(LinearSolid<LinearTetrahedron>(mesh.rest, mesh.elements, LinearLaw(kRubber)),
                    test::has_text("elements 4 to 7"));
}

TEST_CASE("energies by name of law agree with those by type", "[solid]") {
  for (int n : {4, 10}) {
    const SolidMesh mesh = ball(n);
    const VecX<double> x = Kind<LinearTetrahedron, NeoHookean>::state(mesh);
    auto made = [&](SolidLaw law) {
      return force(*make_solid_energy(law, mesh.rest, mesh.elements, kRubber), x);
    };
    auto same = [&](SolidLaw name, auto law) {
      using Law = decltype(law);
      if (n == 4)
        CHECK(made(name) == force(SolidEnergy<LinearTetrahedron, Law>(mesh.rest, mesh.elements, law), x));
      else
        CHECK(made(name) == force(SolidEnergy<QuadraticTetrahedron, Law>(mesh.rest, mesh.elements, law), x));
    };
    same(SolidLaw::linear, LinearLaw(kRubber));
    same(SolidLaw::st_venant_kirchhoff, StVenantKirchhoff(kRubber));
    same(SolidLaw::neo_hookean, NeoHookean(kRubber));
    same(SolidLaw::neo_hookean_log, NeoHookeanLog(kRubber));
    same(SolidLaw::corotated, Corotated(kRubber));
    CHECK((made(SolidLaw::averaged_linear) - made(SolidLaw::linear)).norm() >
          1e-3 * made(SolidLaw::linear).norm());
  }
  CHECK_THROWS_WITH(make_solid_energy(SolidLaw::linear, Nodes(8, 3), Eigen::MatrixXi(8, 1), kRubber),
                    test::has_text("4, 10 or 15"));
}

TEST_CASE("masses: sums, moments, positive values", "[solid]") {
  for (int n : {4, 10, 15}) {
    INFO(n);
    const SolidMesh mesh = ball(n);
    const VecX<double> lumped = lumped_mass(mesh.rest, mesh.elements, 3);
    Eigen::SparseMatrix<double> M(mesh.n(), mesh.n());
    const auto entries = consistent_mass(mesh.rest, mesh.elements, 3);
    M.setFromTriplets(entries.begin(), entries.end());
    const VecX<double> ones = VecX<double>::Ones(mesh.n()), z = mesh.rest.col(2);
    CHECK(lumped.minCoeff() > 0);
    CHECK(lumped.sum() == Approx(ones.dot(M * ones)).epsilon(n == 15 ? 1e-3 : 1e-14));
    if (n == 4) CHECK((lumped - M * ones).norm() <= 1e-14 * lumped.norm());
    if (n == 10) CHECK((M * ones).minCoeff() < 0);
    // The integral of rho z^2 over the unit ball is 4 pi rho / 15.
    const double exact = 3 * 4 * kPi / 15;
    CHECK(z.dot(M * z) == Approx(exact).epsilon(n == 4 ? 0.15 : 0.02));
    CHECK(z.dot(lumped.cwiseProduct(z)) == Approx(exact).epsilon(n == 15 ? 0.005 : 0.2));
  }
  CHECK_THROWS_WITH(lumped_mass(Nodes(1, 3), Eigen::MatrixXi(8, 1), 1), test::has_text("8 nodes"));
}

TEST_CASE("rules of tetrahedra: exact to their degree, shape functions sum to one", "[solid]") {
  auto worst = [](const auto& rule, int degree) {
    test::Worst error;
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j)
        for (int k = 0; i + j + k <= degree; ++k) {
          double sum = 0;
          for (const TetrahedronPoint& at : rule)
            sum += at.weight * std::pow(at.L[1], i) * std::pow(at.L[2], j) * std::pow(at.L[3], k);
          const double exact =
              std::tgamma(i + 1) * std::tgamma(j + 1) * std::tgamma(k + 1) / std::tgamma(i + j + k + 4);
          error.note(std::abs(sum / exact - 1));
        }
    return static_cast<double>(error);
  };
  CHECK(worst(LinearTetrahedron::rule, 1) <= 1e-14);
  CHECK(worst(QuadraticTetrahedron::rule, 3) <= 1e-14);
  CHECK(worst(kTetrahedronMassRule, 5) <= 1e-14);
  CHECK(worst(kEnrichedNodes, 3) <= 1e-14);
  for (const TetrahedronPoint& at : kTetrahedronMassRule) {
    CHECK(LinearTetrahedron::N(at).sum() == Approx(1).epsilon(1e-14));
    CHECK(QuadraticTetrahedron::N(at).sum() == Approx(1).epsilon(1e-14));
    CHECK(EnrichedTetrahedron::N(at).sum() == Approx(1).epsilon(1e-14));
  }
  for (std::size_t a = 0; a < 15; ++a)
    CHECK((EnrichedTetrahedron::N(kEnrichedNodes[a]) - Vec<double, 15>::Unit(static_cast<Eigen::Index>(a)))
              .norm() <= 1e-14);
}

}  // namespace solid_energy_test
