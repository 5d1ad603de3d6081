// Modes of solids against analytic solutions: the free sphere of Lamb (1882), Timoshenko beams, bars.
#include "catch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <pliant/local/solid/solid_energy.h>
#include <pliant/local/solid/solid_mass.h>

#include "solid_meshes.h"
#include "sparse_modes.h"

namespace solid_modes_test {

using namespace pliant;
using test::Modes;
using test::SolidMesh;
using Order = Solid::Order;

namespace {

enum class Mass { lumped, consistent };

struct Matrices {
  test::Sparse K, M;
};
template <class Element>
Matrices matrices(const SolidMesh& mesh, const Elasticity& material, Mass mass) {
  const LinearSolid<Element> energy(mesh.rest, mesh.elements, LinearLaw(material));
  return {test::stiffness_at(energy, VecX<double>::Zero(3 * mesh.n())),
          mass == Mass::lumped ? test::in_space(lumped_mass(mesh.rest, mesh.elements, 1))
                               : test::in_space(consistent_mass(mesh.rest, mesh.elements, 1), mesh.n())};
}

/// Returns local coordinates whose vector at each node is f(X), with the rest position X of the node.
template <class F>
VecX<double> field(const SolidMesh& mesh, F&& f) {
  VecX<double> u(3 * mesh.n());
  for (int i = 0; i < mesh.n(); ++i) {
    const Vec3<double> X = mesh.rest.row(i);
    nodes(u, mesh.n()).row(i) = Vec3<double>(f(X)).transpose();
  }
  return u;
}

/// Relative errors of omega r / c_t of the unit sphere with nu_P = 0.3, with the speed c_t of shear waves.
/// The modes are the torsional modes of degree 2 (T2, five modes), the spheroidal modes of degrees 2 and 1
/// (S2, five; S1, three), and breathing. Modes S2 (of second radial order, 0.2 % away) and S4 (1 % away) mix
/// with breathing on a mesh. Therefore the error of breathing is that of its exact field, smoothed on the
/// mesh.
struct LambErrors {
  double T2, S2, S1, breathing;
};
template <class Element>
LambErrors lamb(int resolution, Mass mass) {
  const SolidMesh mesh = test::solid_mesh("sphere", {}, resolution, test::order_of(Element::n_nodes));
  const auto [K, M] = matrices<Element>(mesh, Elasticity(2.6, 0.3), mass);
  const VecX<double> eta = test::modes_near(K, M, 9, 13).values.cwiseSqrt();
  const double breathing = 4.995514, x = breathing / std::sqrt(3.5);  // omega r / c_l
  const VecX<double> breathing_field = field(mesh, [&](const Vec3<double>& X) -> Vec3<double> {
    const double r = X.norm();
    return r == 0 ? X : Vec3<double>(std::sph_bessel(1, x * r) / r * X);
  });
  const double found = test::SmoothedFields(K, M, 0.5 * breathing * breathing).values(breathing_field)[0];
  return {eta.segment(0, 5).mean() / 2.50113 - 1, eta.segment(5, 5).mean() / 2.64622 - 1,
          eta.segment(10, 3).mean() / 3.52999 - 1, std::sqrt(found) / breathing - 1};
}
/// Returns the order of convergence from two errors; ratio: ratio of their edge lengths.
double order(double coarse, double fine, double ratio) {
  return std::log(std::abs(coarse / fine)) / std::log(ratio);
}

}  // namespace

TEST_CASE("Lamb's sphere by linear elements, lumped mass: second order", "[modes][long]") {
  const LambErrors coarse = lamb<LinearTetrahedron>(3, Mass::lumped),
                   fine = lamb<LinearTetrahedron>(6, Mass::lumped);
  CHECK(std::abs(fine.T2) < 0.004);
  CHECK(std::abs(fine.S2) < 0.011);
  CHECK(std::abs(fine.S1) < 0.02);
  CHECK(order(coarse.T2, fine.T2, 2) == Approx(2).margin(0.5));
  CHECK(order(coarse.S2, fine.S2, 2) == Approx(2).margin(0.3));
  CHECK(order(coarse.S1, fine.S1, 2) == Approx(2).margin(0.3));
  CHECK(std::abs(fine.breathing) < 0.0014);
  CHECK(order(coarse.breathing, fine.breathing, 2) == Approx(2).margin(0.3));
}

TEST_CASE("Lamb's sphere by quadratic elements, consistent mass: fourth order, from above", "[modes][long]") {
  const LambErrors coarse = lamb<QuadraticTetrahedron>(2, Mass::consistent),
                   fine = lamb<QuadraticTetrahedron>(3, Mass::consistent);
  for (double error : {fine.T2, fine.S2, fine.S1}) {
    CHECK(error > 0);
    CHECK(error < 1e-3);
  }
  CHECK(order(coarse.T2, fine.T2, 1.5) > 3.6);
  CHECK(order(coarse.S2, fine.S2, 1.5) > 3.6);
  CHECK(order(coarse.S1, fine.S1, 1.5) > 3.5);
  CHECK(std::abs(fine.breathing) < 7.5e-5);
  CHECK(order(coarse.breathing, fine.breathing, 1.5) > 3.5);
}

TEST_CASE("Lamb's sphere by quadratic elements, lumped mass: second order only", "[modes][long]") {
  const LambErrors coarse = lamb<QuadraticTetrahedron>(2, Mass::lumped),
                   fine = lamb<QuadraticTetrahedron>(3, Mass::lumped);
  CHECK(order(coarse.T2, fine.T2, 1.5) == Approx(2).margin(0.3));
  CHECK(order(coarse.S1, fine.S1, 1.5) == Approx(2).margin(0.4));
  CHECK(std::abs(fine.T2) < 0.013);
  CHECK(std::abs(fine.S1) < 0.025);
}

TEST_CASE("Lamb's sphere by enriched elements, lumped mass: fourth order", "[modes][long]") {
  const LambErrors coarse = lamb<EnrichedTetrahedron>(1, Mass::lumped),
                   fine = lamb<EnrichedTetrahedron>(2, Mass::lumped);
  CHECK(std::abs(fine.T2) < 0.0011);
  CHECK(std::abs(fine.S2) < 0.0009);
  CHECK(std::abs(fine.S1) < 0.0022);
  CHECK(std::abs(fine.breathing) < 0.00064);
  CHECK(order(coarse.S1, fine.S1, 2) > 3);
  CHECK(order(coarse.breathing, fine.breathing, 2) > 2.7);
}

TEST_CASE("Lamb's sphere on fine meshes of linear elements", "[modes][.extended]") {
  const LambErrors coarse = lamb<LinearTetrahedron>(5, Mass::lumped),
                   fine = lamb<LinearTetrahedron>(10, Mass::lumped);
  CHECK(order(coarse.S2, fine.S2, 2) == Approx(2).margin(0.15));
  CHECK(order(coarse.S1, fine.S1, 2) == Approx(2).margin(0.15));
  CHECK(order(coarse.breathing, fine.breathing, 2) == Approx(2).margin(0.15));
  CHECK(std::abs(fine.S1) < 0.0068);
  CHECK(std::abs(fine.breathing) < 0.00046);
}

TEST_CASE("Lamb's sphere on fine meshes of quadratic elements", "[modes][long]") {
  const LambErrors coarse = lamb<QuadraticTetrahedron>(3, Mass::consistent),
                   fine = lamb<QuadraticTetrahedron>(4, Mass::consistent);
  CHECK(order(coarse.T2, fine.T2, 4.0 / 3) > 3.8);
  CHECK(order(coarse.S2, fine.S2, 4.0 / 3) > 3.8);
  CHECK(order(coarse.S1, fine.S1, 4.0 / 3) > 3.7);
  CHECK(order(coarse.breathing, fine.breathing, 4.0 / 3) > 3.7);
  CHECK(std::abs(fine.S1) < 3.3e-4);
  CHECK(std::abs(fine.breathing) < 2.5e-5);
}

TEST_CASE("Lamb's sphere on fine meshes of enriched elements", "[modes][long]") {
  const LambErrors coarse = lamb<EnrichedTetrahedron>(2, Mass::lumped),
                   fine = lamb<EnrichedTetrahedron>(3, Mass::lumped);
  CHECK(order(coarse.T2, fine.T2, 1.5) > 3.5);
  CHECK(order(coarse.S2, fine.S2, 1.5) > 3.5);
  CHECK(order(coarse.S1, fine.S1, 1.5) > 3.5);
  CHECK(order(coarse.breathing, fine.breathing, 1.5) > 3.9);
  CHECK(std::abs(fine.S1) < 0.0004);
  CHECK(std::abs(fine.breathing) < 0.00012);
}

namespace {

/// A cylinder of r = 1, E = 1, rho = 1 along z, with elements of 10 nodes.
struct Bar {
  double L, nu;
  SolidMesh mesh;
  Matrices whole;

  Bar(double length, int resolution, double poisson)
      : L(length),
        nu(poisson),
        mesh(test::solid_mesh("cylinder", {{"a3", length / 2}}, resolution, Order::quadratic)),
        whole(matrices<QuadraticTetrahedron>(mesh, Elasticity(1, poisson), Mass::consistent)) {}

  /// Returns sqrt(E I / (rho A)) / L^2, the unit of the bending frequencies.
  double unit() const { return 0.5 / (L * L); }
  double shear_speed() const { return std::sqrt(1 / (2 * (1 + nu))); }
  bool at_end(int node, double z) const { return std::abs(mesh.rest(node, 2) - z) < 1e-9; }
  /// Returns the matrix S that maps the free coordinates to all coordinates. Coordinates of nodes at the
  /// given ends z are not free.
  test::Sparse free_coordinates(const std::vector<double>& ends) const {
    std::vector<Eigen::Triplet<double>> entries;
    int n = 0;
    for (int r = 0; r < 3; ++r)
      for (int i = 0; i < mesh.n(); ++i)
        if (std::none_of(ends.begin(), ends.end(), [&](double z) { return at_end(i, z); }))
          entries.emplace_back(r * mesh.n() + i, n++, 1);
    test::Sparse S(3 * mesh.n(), n);
    S.setFromTriplets(entries.begin(), entries.end());
    return S;
  }

  // Mode shapes as functions of s = z/L + 1/2.

  template <class F>
  MatX<double> stretching(F&& f) const {
    return field(mesh, [&](const Vec3<double>& X) { return Vec3<double>(0, 0, f(X[2] / L + 0.5)); });
  }
  template <class F>
  MatX<double> torsion(F&& f) const {
    return field(mesh, [&](const Vec3<double>& X) -> Vec3<double> {
      return f(X[2] / L + 0.5) * Vec3<double>(-X[1], X[0], 0);
    });
  }
  /// Returns the modes of the Euler-Bernoulli beam along x and along y, as two columns. root: wave number
  /// times L. The end s = 0 is free or clamped; the end s = 1 is free.
  MatX<double> bending(double root, bool clamped) const {
    const double sign = clamped ? 1 : -1, fraction = (std::cosh(root) + sign * std::cos(root)) /
                                                     (std::sinh(root) + sign * std::sin(root));
    MatX<double> both(3 * mesh.n(), 2);
    for (int axis = 0; axis < 2; ++axis)
      both.col(axis) = field(mesh, [&](const Vec3<double>& X) -> Vec3<double> {
        const double b = root * (X[2] / L + 0.5);
        return (std::cosh(b) - sign * std::cos(b) - fraction * (std::sinh(b) - sign * std::sin(b))) *
               Vec3<double>::Unit(axis);
      });
    return both;
  }
};

/// Returns omega of the mode with the largest fraction of its modal mass in the given fields. Checks that
/// this fraction is above 0.75.
double mode_frequency(const Modes& modes, const test::Sparse& M, const MatX<double>& fields) {
  double best = 0, omega = 0;
  for (Eigen::Index i = 0; i < modes.values.size(); ++i) {
    const VecX<double> m = M * modes.vectors.col(i);
    double fraction = 0;
    for (const auto& shape : fields.colwise())
      fraction += std::pow(shape.dot(m), 2) / (shape.dot(M * shape) * modes.vectors.col(i).dot(m));
    if (fraction <= best) continue;
    best = fraction;
    omega = std::sqrt(modes.values[i]);
  }
  CHECK(best > 0.75);  // the rest of the modal mass is mainly rotation of the sections
  return omega;
}

constexpr std::array<double, 3> kFreeRoots{4.730041, 7.853205, 10.995608},
    kClampedRoots{1.875104, 4.694091, 7.854757};

/// Bending frequencies of a free bar with nu = 0.3, in units of sqrt(E I / (rho A)) / L^2. kBeam10 and
/// kBeam20: Timoshenko's beam for L / r = 10 and 20. kSolid10: the solid for L / r = 10 (polynomials of
/// degree 10, tests/part/bases.cpp).
constexpr std::array<double, 3> kBeam10{20.3813, 49.2314, 83.9790}, kBeam20{21.8046, 57.5396, 106.6438},
    kSolid10{20.41175, 49.4462, 84.565};

/// Results for a free bar: bending frequencies in units of Bar::unit(), and relative errors of torsion and of
/// stretching with lateral inertia (Rayleigh, Love).
struct FreeBar {
  std::array<double, 3> bending;
  double torsion, stretch;
};
FreeBar free_bar(double L, int resolution) {
  const Bar bar(L, resolution, 0.3);
  const auto& [K, M] = bar.whole;
  const Modes modes = test::modes_near(K, M, -0.1 * std::pow(20 * bar.unit(), 2), 17, 12);
  const VecX<double>& values = modes.values;
  CHECK(values.head<6>().cwiseAbs().maxCoeff() < 1e-9 * values[11]);
  CHECK(values[7] == Approx(values[6]).epsilon(1e-6));  // one mode in each of two planes
  FreeBar found{};
  for (std::size_t k = 0; k < 3; ++k)
    found.bending[k] = mode_frequency(modes, M, bar.bending(kFreeRoots[k], false)) / bar.unit();
  auto wave = [](double s) { return std::cos(kPi * s); };
  found.torsion = mode_frequency(modes, M, bar.torsion(wave)) / (kPi / L * bar.shear_speed()) - 1;
  found.stretch =
      mode_frequency(modes, M, bar.stretching(wave)) / (kPi / L * (1 - std::pow(0.3 * kPi / L, 2) / 4)) - 1;
  return found;
}
double bending_order(const FreeBar& coarse, const FreeBar& fine, std::size_t k, double ratio) {
  return order(coarse.bending[k] / kSolid10[k] - 1, fine.bending[k] / kSolid10[k] - 1, ratio);
}

/// Relative errors of a bar that is clamped at one end. Torsion: the first two frequencies against (n - 1/2)
/// pi c / L with the speed c of shear waves, which is exact for the solid. Stretching: the first two
/// frequencies against this formula with c = sqrt(E / rho), which is exact for nu = 0 (no lateral contraction
/// at the clamp). Bending: the first three frequencies against Timoshenko's beam with nu = 0.3.
struct ClampedErrors {
  std::array<double, 2> torsion, stretch;
  std::array<double, 3> bending;
};
ClampedErrors clamped_bar(int resolution, double nu) {
  const Bar bar(10, resolution, nu);
  const test::Sparse S = bar.free_coordinates({-bar.L / 2}), K = S.transpose() * bar.whole.K * S,
                     M = S.transpose() * bar.whole.M * S;
  const Modes modes = test::modes_near(K, M, 0, 12, 12);
  ClampedErrors errors;
  for (std::size_t k = 0; k < 2; ++k) {
    const double wave = (static_cast<double>(k) + 0.5) * kPi;
    auto shape = [&](double s) { return std::sin(wave * s); };
    errors.torsion[k] =
        mode_frequency(modes, M, S.transpose() * bar.torsion(shape)) / (wave / bar.L * bar.shear_speed()) - 1;
    errors.stretch[k] = mode_frequency(modes, M, S.transpose() * bar.stretching(shape)) / (wave / bar.L) - 1;
  }
  const std::array<double, 3> beam{3.43881, 19.2125, 47.0589};
  for (std::size_t k = 0; k < 3; ++k)
    errors.bending[k] = mode_frequency(modes, M, S.transpose() * bar.bending(kClampedRoots[k], true)) /
                            (beam[k] * bar.unit()) -
                        1;
  return errors;
}

/// Relative errors of the statics of a bar with nu = 0 that is clamped at one end. The exact deflection under
/// a force F at the other end is F L^3 / (3 E I), plus F L / (kappa G A) by shear. The exact torque that
/// rotates this end by theta is T = G J theta / L.
struct StaticErrors {
  double deflection, torque;
};
StaticErrors loaded_bar(int resolution) {
  const Bar bar(10, resolution, 0);
  const test::Sparse& K = bar.whole.K;
  const double L = bar.L, I = kPi / 4, A = kPi, J = kPi / 2, G = 0.5, kappa = 6.0 / 7;
  // The force is distributed over the face: on flat triangles each edge node receives a third.
  VecX<double> F = VecX<double>::Zero(K.rows());
  for (const auto& face : bar.mesh.boundary.colwise()) {
    if (!std::all_of(face.begin(), face.end(), [&](int node) { return bar.at_end(node, L / 2); })) continue;
    auto corner = [&](int k) -> Vec3<double> { return bar.mesh.rest.row(face[k]); };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (int k = 3; k < 6; ++k) F[face[k]] += area / 3;
  }
  F /= F.sum();
  auto solve = [&](const test::Sparse& S, const VecX<double>& f) -> VecX<double> {
    const Eigen::SimplicialLDLT<test::Sparse> factor(test::Sparse(S.transpose() * K * S));
    return S * factor.solve(S.transpose() * f);
  };
  const double deflection = F.dot(solve(bar.free_coordinates({-L / 2}), F));
  VecX<double> u = bar.torsion([](double s) { return s; });  // has the prescribed displacements of the ends
  u -= solve(bar.free_coordinates({-L / 2, L / 2}), K * u);
  return {deflection / (L * L * L / (3 * I) + L / (kappa * G * A)) - 1, u.dot(K * u) / (G * J / L) - 1};
}

}  // namespace

TEST_CASE("a free cylinder: bending, torsion and stretching frequencies", "[modes][long]") {
  const FreeBar bar = free_bar(10, 3), coarse = free_bar(10, 2);
  CHECK(bar.bending[0] == Approx(kBeam10[0]).epsilon(0.006));
  CHECK(bar.bending[1] == Approx(kBeam10[1]).epsilon(0.017));
  CHECK(bar.bending[2] == Approx(kBeam10[2]).epsilon(0.038));
  CHECK(bar.torsion == Approx(0).margin(0.004));
  CHECK(bar.stretch == Approx(0).margin(0.0005));
  for (std::size_t k = 0; k < 3; ++k) CHECK(bending_order(coarse, bar, k, 1.5) > (k == 0 ? 2.5 : 3.2));
  CHECK(order(coarse.torsion, bar.torsion, 1.5) > 3.2);
}

TEST_CASE("free cylinders on fine meshes: frequencies and their orders", "[modes][.extended]") {
  const FreeBar coarse = free_bar(10, 4), thick = free_bar(10, 5), slender = free_bar(20, 5);
  CHECK(thick.bending[0] == Approx(kBeam10[0]).epsilon(0.003));
  CHECK(thick.bending[1] == Approx(kBeam10[1]).epsilon(0.008));
  CHECK(thick.bending[2] == Approx(kBeam10[2]).epsilon(0.0137));
  CHECK(thick.torsion == Approx(0).margin(0.001));
  CHECK(slender.bending[0] == Approx(kBeam20[0]).epsilon(0.006));
  CHECK(slender.bending[1] == Approx(kBeam20[1]).epsilon(0.015));
  CHECK(slender.bending[2] == Approx(kBeam20[2]).epsilon(0.0295));
  CHECK(slender.torsion == Approx(0).margin(0.003));
  CHECK(slender.stretch == Approx(0).margin(0.0005));
  for (std::size_t k = 0; k < 3; ++k) CHECK(bending_order(coarse, thick, k, 1.25) > 3);
  CHECK(order(coarse.torsion, thick.torsion, 1.25) > 3.4);
}

TEST_CASE("a cantilever cylinder: bending, torsion and stretching frequencies", "[modes][long]") {
  const ClampedErrors coarse = clamped_bar(2, 0), fine = clamped_bar(3, 0);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(std::abs(fine.torsion[k]) < (k == 0 ? 0.0019 : 0.0078));
    CHECK(std::abs(fine.stretch[k]) < (k == 0 ? 3e-5 : 5.3e-4));
    CHECK(order(coarse.torsion[k], fine.torsion[k], 1.5) > (k == 0 ? 3.9 : 3.3));
    CHECK(order(coarse.stretch[k], fine.stretch[k], 1.5) > (k == 0 ? 3.9 : 3.7));
  }
  // The clamp prevents lateral contraction of the clamped face. Timoshenko's beam neglects this; the solid is
  // about 1 % stiffer.
  const ClampedErrors contracting = clamped_bar(3, 0.3);
  CHECK(contracting.bending[0] == Approx(0).margin(0.0235));
  CHECK(contracting.bending[1] == Approx(0).margin(0.0255));
  CHECK(contracting.bending[2] == Approx(0).margin(0.0315));
  CHECK(std::abs(contracting.torsion[0]) < 0.0025);
}

TEST_CASE("a cantilever cylinder: deflection F L^3 / 3 E I and rotation T L / G J", "[modes][long]") {
  const StaticErrors coarse = loaded_bar(2), middle = loaded_bar(3), fine = loaded_bar(4);
  CHECK(std::abs(fine.deflection) < 0.0048);
  CHECK(std::abs(fine.torque) < 0.00065);
  CHECK(order(coarse.deflection, middle.deflection, 1.5) > 3.4);
  CHECK(order(middle.deflection, fine.deflection, 4.0 / 3) > 3.7);
  CHECK(order(coarse.torque, middle.torque, 1.5) > 4.3);
  CHECK(order(middle.torque, fine.torque, 4.0 / 3) > 4.4);
}

}  // namespace solid_modes_test
