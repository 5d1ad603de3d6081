// Modes of solids against analysis: the free sphere of Lamb (1882), beams of Timoshenko, bars.
#include "catch.h"

#include <cmath>
#include <numeric>

#include <pliant/local/solid_energy.h>
#include <pliant/local/solid_mass.h>

#include "solid_meshes.h"
#include "sparse_modes.h"

namespace solid_modes_test {

using namespace pliant;
using test::Modes;
using test::SolidMesh;
using Order = Solid::Order;

namespace {

enum class Mass { lumped, consistent };

template <class Element>
Modes modes(const SolidMesh& mesh, const Elasticity& material, Mass mass, double shift, int wanted) {
  const LinearSolid<Element> energy(mesh.rest, mesh.elements, LinearLaw(material));
  return test::modes_near(test::stiffness_at(energy, VecX<double>::Zero(3 * mesh.n())),
                          mass == Mass::lumped
                              ? test::in_space(lumped_mass(mesh.rest, mesh.elements, 1))
                              : test::in_space(consistent_mass(mesh.rest, mesh.elements, 1), mesh.n()),
                          shift, wanted);
}

/// Relative errors of omega r / c_t of the unit sphere with nu_P = 0.3: T2 and S2 (five modes each), S1
/// (three).
struct LambErrors {
  double T2, S2, S1;
};
template <class Element>
LambErrors lamb(int resolution, Mass mass) {
  const SolidMesh mesh = test::solid_mesh("sphere", {}, resolution, test::order_of(Element::n_nodes));
  const VecX<double> eta = modes<Element>(mesh, Elasticity(2.6, 0.3), mass, 9, 13).values.cwiseSqrt();
  return {eta.segment(0, 5).mean() / 2.50113 - 1, eta.segment(5, 5).mean() / 2.64622 - 1,
          eta.segment(10, 3).mean() / 3.52999 - 1};
}
/// Of the mode that breathes most.
template <class Element>
double breathing(int resolution, Mass mass) {
  const SolidMesh mesh = test::solid_mesh("sphere", {}, resolution, test::order_of(Element::n_nodes));
  const Modes found = modes<Element>(mesh, Elasticity(2.6, 0.3), mass, 25.0, 14);
  const VecX<double> radial = mesh.rest.reshaped(),
                     m = lumped_mass(mesh.rest, mesh.elements, 1).replicate(3, 1);
  Eigen::Index best = 0;
  (found.vectors.transpose() * m.cwiseProduct(radial)).cwiseAbs().maxCoeff(&best);
  return std::sqrt(found.values[best]) / 4.99551 - 1;
}
double order(double coarse, double fine, double ratio) {
  return std::log(std::abs(coarse / fine)) / std::log(ratio);
}

}  // namespace

TEST_CASE("Lamb's sphere by linear elements, lumped: second order", "[modes][long]") {
  const LambErrors coarse = lamb<LinearTetrahedron>(3, Mass::lumped),
                   fine = lamb<LinearTetrahedron>(6, Mass::lumped);
  CHECK(std::abs(fine.T2) < 0.004);
  CHECK(std::abs(fine.S2) < 0.011);
  CHECK(std::abs(fine.S1) < 0.02);
  CHECK(order(coarse.T2, fine.T2, 2) == Approx(2).margin(0.5));
  CHECK(order(coarse.S2, fine.S2, 2) == Approx(2).margin(0.3));
  CHECK(order(coarse.S1, fine.S1, 2) == Approx(2).margin(0.3));
  CHECK(std::abs(breathing<LinearTetrahedron>(5, Mass::lumped)) < 0.01);
}

TEST_CASE("Lamb's sphere by quadratic elements, consistent: fourth order, from above", "[modes][long]") {
  const LambErrors coarse = lamb<QuadraticTetrahedron>(2, Mass::consistent),
                   fine = lamb<QuadraticTetrahedron>(3, Mass::consistent);
  for (double error : {fine.T2, fine.S2, fine.S1}) {
    CHECK(error > 0);
    CHECK(error < 1e-3);
  }
  CHECK(order(coarse.T2, fine.T2, 1.5) > 3.6);
  CHECK(order(coarse.S2, fine.S2, 1.5) > 3.6);
  CHECK(order(coarse.S1, fine.S1, 1.5) > 3.5);
  CHECK(std::abs(breathing<QuadraticTetrahedron>(2, Mass::consistent)) < 5e-3);
}

TEST_CASE("Lamb's sphere by quadratic elements, lumped: second order only", "[modes][long]") {
  const LambErrors coarse = lamb<QuadraticTetrahedron>(2, Mass::lumped),
                   fine = lamb<QuadraticTetrahedron>(3, Mass::lumped);
  CHECK(order(coarse.T2, fine.T2, 1.5) == Approx(2).margin(0.3));
  CHECK(order(coarse.S1, fine.S1, 1.5) == Approx(2).margin(0.4));
  CHECK(std::abs(fine.T2) < 0.013);
  CHECK(std::abs(fine.S1) < 0.025);
}

TEST_CASE("Lamb's sphere by enriched elements, lumped: fourth order", "[modes][long]") {
  const LambErrors coarse = lamb<EnrichedTetrahedron>(1, Mass::lumped),
                   fine = lamb<EnrichedTetrahedron>(2, Mass::lumped);
  CHECK(std::abs(fine.T2) < 0.0011);
  CHECK(std::abs(fine.S2) < 0.0009);
  CHECK(std::abs(fine.S1) < 0.0022);
  CHECK(order(coarse.S1, fine.S1, 2) > 3);
}

TEST_CASE("Lamb's sphere on fine meshes by linear elements", "[modes][long]") {
  const LambErrors coarse = lamb<LinearTetrahedron>(5, Mass::lumped),
                   fine = lamb<LinearTetrahedron>(10, Mass::lumped);
  CHECK(order(coarse.S2, fine.S2, 2) == Approx(2).margin(0.15));
  CHECK(order(coarse.S1, fine.S1, 2) == Approx(2).margin(0.15));
}

TEST_CASE("Lamb's sphere on fine meshes by quadratic elements", "[modes][long]") {
  const LambErrors coarse = lamb<QuadraticTetrahedron>(3, Mass::consistent),
                   fine = lamb<QuadraticTetrahedron>(4, Mass::consistent);
  CHECK(order(coarse.T2, fine.T2, 4.0 / 3) > 3.8);
  CHECK(order(coarse.S2, fine.S2, 4.0 / 3) > 3.8);
  CHECK(order(coarse.S1, fine.S1, 4.0 / 3) > 3.7);
}

TEST_CASE("Lamb's sphere on fine meshes by enriched elements", "[modes][long]") {
  const LambErrors coarse = lamb<EnrichedTetrahedron>(2, Mass::lumped),
                   fine = lamb<EnrichedTetrahedron>(3, Mass::lumped);
  CHECK(order(coarse.T2, fine.T2, 1.5) > 3.5);
  CHECK(order(coarse.S2, fine.S2, 1.5) > 3.5);
  CHECK(order(coarse.S1, fine.S1, 1.5) > 3.5);
}

namespace {

/// Of a free cylinder, r = 1, E = 1, rho = 1, nu_P = 0.3: relative errors of the first two bending
/// frequencies (Timoshenko), of torsion, and of stretching with the inertia of its thinning (Rayleigh, Love).
struct BeamErrors {
  double first, second, torsion, stretch;
};
BeamErrors beam(double L, int resolution) {
  const std::array<double, 2> bending =
      L == 10 ? std::array<double, 2>{20.3813, 49.2314} : std::array<double, 2>{21.8046, 57.5396};
  const SolidMesh mesh = test::solid_mesh("cylinder", {{"a3", L / 2}}, resolution, Order::quadratic);
  const double unit = 0.5 / (L * L), twist = kPi / L * std::sqrt(1 / 2.6);  // sqrt(E I / rho A) / L^2
  const double stretch = kPi / L * (1 - std::pow(0.3 * kPi / L, 2) / 4);
  const VecX<double> values =
      modes<QuadraticTetrahedron>(mesh, Elasticity(1, 0.3), Mass::consistent,
                                  -0.1 * std::pow(bending[0] * unit, 2), L == 10 ? 12 : 15)
          .values;
  CHECK(values.head<6>().cwiseAbs().maxCoeff() < 1e-9 * values[11]);
  CHECK(values[7] == Approx(values[6]).epsilon(1e-6));  // each in two planes
  auto nearest = [&](double omega) {
    double best = kInfinity;
    for (double value : values) {
      const double error = std::sqrt(std::max(value, 0.0)) / omega - 1;
      if (std::abs(error) < std::abs(best)) best = error;
    }
    return best;
  };
  return {std::sqrt(values[6]) / (bending[0] * unit) - 1, nearest(bending[1] * unit), nearest(twist),
          nearest(stretch)};
}

}  // namespace

TEST_CASE("a free cylinder: bending, torsion and stretching", "[modes][long]") {
  const BeamErrors errors = beam(10, 3), coarse = beam(10, 2);
  CHECK(errors.first == Approx(0).margin(0.006));
  CHECK(errors.second == Approx(0).margin(0.017));
  CHECK(errors.torsion == Approx(0).margin(0.004));
  CHECK(errors.stretch == Approx(0).margin(0.0005));
  CHECK(errors.first < 0.5 * coarse.first);
  CHECK(errors.second < 0.5 * coarse.second);
  CHECK(errors.torsion < 0.4 * coarse.torsion);
}

TEST_CASE("free cylinders on fine meshes", "[modes][long]") {
  const BeamErrors thick = beam(10, 5), slender = beam(20, 5);
  CHECK(thick.first == Approx(0).margin(0.003));
  CHECK(thick.second == Approx(0).margin(0.008));
  CHECK(thick.torsion == Approx(0).margin(0.001));
  CHECK(slender.first == Approx(0).margin(0.006));
  CHECK(slender.second == Approx(0).margin(0.015));
  CHECK(slender.torsion == Approx(0).margin(0.003));
  CHECK(slender.stretch == Approx(0).margin(0.0005));
}

TEST_CASE("a cantilever cylinder bends as Timoshenko's", "[modes]") {
  const double L = 10, unit = 0.5 / (L * L);
  const SolidMesh mesh = test::solid_mesh("cylinder", {{"a3", L / 2}}, 3, Order::quadratic);
  const LinearSolid<QuadraticTetrahedron> energy(mesh.rest, mesh.elements, LinearLaw(Elasticity(1, 0.3)));
  test::Sparse K = test::stiffness_at(energy, VecX<double>::Zero(3 * mesh.n()));
  const test::Sparse M = test::in_space(consistent_mass(mesh.rest, mesh.elements, 1), mesh.n());
  for (int i = 0; i < mesh.n(); ++i)
    if (mesh.rest(i, 2) < -L / 2 + 1e-9)
      for (int r = 0; r < 3; ++r) K.coeffRef(r * mesh.n() + i, r * mesh.n() + i) += 1e4;
  // The clamp keeps its face from narrowing, which Timoshenko's beam does not know: stiffer by some 1 %.
  const VecX<double> omega = test::modes_near(K, M, 0, 4).values.cwiseSqrt();
  CHECK(omega[0] == Approx(omega[1]).epsilon(1e-6));
  CHECK(omega[0] == Approx(3.43881 * unit).epsilon(0.025));
  CHECK(omega[2] == Approx(19.2125 * unit).epsilon(0.02));
}

}  // namespace solid_modes_test
