// Checks of every energy of local deformation at coordinates x: the force is minus the gradient of the
// energy, add_derivative() adds the derivative of the force, and add_stiffness() agrees with this derivative.
// add_viscosity() agrees with add_viscous_force(). Results have the same bits for any number of threads. The
// frequency bound is valid.
#pragma once

#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/math/eigenvalues.h>

#include "catch.h"
#include "differences.h"
#include "draws.h"

namespace pliant::test {

inline VecX<double> random_vector(Draws& draws, Eigen::Index n, double size = 1) {
  VecX<double> x(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = draws.uniform(-size, size);
  return x;
}

inline VecX<double> force(const NodalEnergy& energy, const VecX<double>& x, ThreadPool* pool = nullptr) {
  VecX<double> f = VecX<double>::Zero(x.size());
  NodalEnergy::Buffer buffer;
  energy.add_force(x, f, buffer, pool);
  return f;
}
inline VecX<double> derivative(const NodalEnergy& energy, const VecX<double>& x, const VecX<double>& dx,
                               ThreadPool* pool = nullptr) {
  VecX<double> f = VecX<double>::Zero(x.size());
  NodalEnergy::Buffer buffer;
  energy.add_derivative(x, dx, f, buffer, pool);
  return f;
}
inline Eigen::SparseMatrix<double> stiffness(const NodalEnergy& energy, const VecX<double>& x) {
  std::vector<Eigen::Triplet<double>> triplets;
  energy.add_stiffness(x, triplets);
  Eigen::SparseMatrix<double> K(x.size(), x.size());
  K.setFromTriplets(triplets.begin(), triplets.end());
  return K;
}

/// Checks the force and its derivative along random directions. h: step for which differences of tenth order
/// are exact to rounding.
inline void check_slopes(const NodalEnergy& energy, const VecX<double>& x, double h) {
  Draws draws(7);
  const VecX<double> f = force(energy, x);
  for (int trial = 0; trial < 3; ++trial) {
    const VecX<double> dx = random_vector(draws, x.size());
    const auto at = [&](long double t) -> VecX<double> { return x + static_cast<double>(t) * dx; };
    const double slope = first_derivative([&](long double t) { return energy.energy(at(t)); }, h);
    const VecX<double> K_dx = derivative(energy, x, dx);
    const double scale = f.norm() * dx.norm() + h * K_dx.norm() * dx.norm();
    CHECK(std::abs(slope + f.dot(dx)) <= 1e-9 * scale);
    VecX<double> change = VecX<double>::Zero(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i)
      change[i] = first_derivative([&](long double t) { return force(energy, at(t))[i]; }, h);
    CHECK((change - K_dx).norm() <= 1e-9 * (K_dx.norm() + f.norm() / h));
  }
}

/// Checks that the assembled stiffness and viscosity are symmetric and agree with add_derivative() and
/// add_viscous_force().
inline void check_stiffness(const NodalEnergy& energy, const VecX<double>& x) {
  Draws draws(8);
  const Eigen::SparseMatrix<double> K = stiffness(energy, x);
  const VecX<double> dx = random_vector(draws, x.size());
  const VecX<double> K_dx = derivative(energy, x, dx);
  CHECK((K * dx + K_dx).norm() <= 1e-12 * K_dx.norm());
  CHECK((K - Eigen::SparseMatrix<double>(K.transpose())).norm() <= 1e-13 * K.norm());
  std::vector<Eigen::Triplet<double>> entries;
  energy.add_viscosity(x, entries);
  Eigen::SparseMatrix<double> V(x.size(), x.size());
  V.setFromTriplets(entries.begin(), entries.end());
  VecX<double> viscous = VecX<double>::Zero(x.size());
  NodalEnergy::Buffer buffer;
  energy.add_viscous_force(x, dx, viscous, buffer, nullptr);
  CHECK((V * dx + viscous).norm() <= 1e-12 * viscous.norm());
  CHECK((V - Eigen::SparseMatrix<double>(V.transpose())).norm() <= 1e-13 * V.norm());
  CHECK(viscous.dot(dx) <= 0);
}

/// Checks that the number of threads does not change a bit of the results. The mesh must have more elements
/// than one range of for_ranges() (local/ranges.h), otherwise a single thread computes all elements.
inline void check_threads(const NodalEnergy& energy, const VecX<double>& x) {
  Draws draws(9);
  const VecX<double> dx = random_vector(draws, x.size());
  const VecX<double> f = force(energy, x), g = derivative(energy, x, dx);
  CHECK(f.norm() > 0);
  for (const int threads : {1, 2, 3}) {
    ThreadPool pool(threads);
    CHECK(force(energy, x, &pool) == f);
    CHECK(derivative(energy, x, dx, &pool) == g);
  }
}

/// Checks that frequency_bound() is at least the largest omega^2 at x with the masses M, and at most `times`
/// this value. The matrix is dense, so the mesh must be small.
inline void check_bound(const NodalEnergy& energy, const VecX<double>& x, const VecX<double>& M,
                        double times) {
  const VecX<double> root = M.cwiseSqrt().cwiseInverse();
  const MatX<double> K = root.asDiagonal() * MatX<double>(stiffness(energy, x)) * root.asDiagonal();
  const double largest = symmetric_eigenvalues(K)[x.size() - 1], bound = energy.frequency_bound(x, M);
  INFO("bound " << bound << ", largest " << largest);
  CHECK(bound >= largest);
  CHECK(bound <= times * largest);
}

}  // namespace pliant::test
