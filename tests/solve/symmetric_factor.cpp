// The factor of small mass matrices against dense algebra: random matrices, coordinates without inertia of
// their own, and derivatives.
#include "catch.h"

#include <cmath>

#include <Eigen/Cholesky>

#include <pliant/solve/symmetric_factor.h>

#include "draws.h"

namespace symmetric_factor_test {

using namespace pliant;
using test::Draws;

namespace {

MatX<double> mass_matrix(Draws& draws, int n) {
  MatX<double> G(n, n);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) G(i, k) = draws.uniform(-1, 1);
  return G * G.transpose() + 0.1 * MatX<double>::Identity(n, n);
}

}  // namespace

TEST_CASE("systems with a mass matrix are solved, for one column and for three") {
  Draws draws(5);
  for (int n = 1; n <= 12; ++n) {
    const MatX<double> A = mass_matrix(draws, n);
    SymmetricFactor<double> factor;
    factor.compute(A, VecX<double>::Zero(n));
    MatX<double> b(n, 3);
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < 3; ++k) b(i, k) = draws.uniform(-1, 1);
    const MatX<double> expected = A.llt().solve(b);
    VecX<double> x = b.col(1);
    factor.solve(x);
    MatX<double> X = b;
    factor.solve_columns<3>(X.data());
    INFO("n = " << n);
    CHECK((x - expected.col(1)).norm() <= 1e-12 * expected.norm());
    CHECK((X - expected).norm() <= 1e-12 * expected.norm());
    CHECK((X.col(1) - x).isZero(0));
    CHECK_FALSE(factor.any_excluded());
  }
}

TEST_CASE("coordinates without inertia get zero solutions, and other coordinates are solved without them") {
  Draws draws(6);
  const int n = 9;
  MatX<double> A = mass_matrix(draws, n);
  // Row 4 is the sum of rows 2 and 3; coordinate 7 has no mass.
  A.row(4) = A.row(2) + A.row(3);
  A.col(4) = A.col(2) + A.col(3);
  A.row(7).setZero();
  A.col(7).setZero();
  SymmetricFactor<double> factor;
  factor.compute(A, VecX<double>::Constant(n, 1e-9));
  CHECK(factor.any_excluded());
  for (int i = 0; i < n; ++i) CHECK(factor.excluded(i) == (i == 4 || i == 7));
  const std::vector<int> free{0, 1, 2, 3, 5, 6, 8};
  MatX<double> free_block(7, 7);
  VecX<double> x(n), b(7);
  for (int i = 0; i < n; ++i) x[i] = draws.uniform(-1, 1);
  for (int i = 0; i < 7; ++i) {
    b[i] = x[free[static_cast<std::size_t>(i)]];
    for (int k = 0; k < 7; ++k)
      free_block(i, k) = A(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(k)]);
  }
  const VecX<double> expected = free_block.llt().solve(b);
  factor.solve(x);
  CHECK(x[4] == 0);
  CHECK(x[7] == 0);
  for (int i = 0; i < 7; ++i)
    CHECK(x[free[static_cast<std::size_t>(i)]] == Approx(expected[i]).epsilon(1e-11).margin(1e-12));
}

TEST_CASE("a pivot that is not a number is not treated as singular, so that it is detected") {
  MatX<double> A = MatX<double>::Identity(3, 3);
  A(1, 1) = std::nan("");
  SymmetricFactor<double> factor;
  factor.compute(A, VecX<double>::Zero(3));
  CHECK_FALSE(factor.excluded(1));
  VecX<double> x = VecX<double>::Ones(3);
  factor.solve(x);
  CHECK(std::isnan(x[1]));
}

TEST_CASE("the derivative of the solution is exact") {
  Draws draws(7);
  const int n = 6;
  const MatX<double> A = mass_matrix(draws, n), dA = mass_matrix(draws, n);
  MatX<Dual<1>> dual(n, n);
  VecX<Dual<1>> x(n);
  VecX<double> b(n);
  for (int i = 0; i < n; ++i) {
    b[i] = draws.uniform(-1, 1);
    x[i] = Dual<1>(b[i]);
    for (int k = 0; k < n; ++k) {
      dual(i, k) = Dual<1>(A(i, k));
      dual(i, k).d[0] = dA(i, k);
    }
  }
  SymmetricFactor<Dual<1>> factor;
  factor.compute(dual, VecX<double>::Zero(n));
  factor.solve(x);
  const VecX<double> value = A.llt().solve(b), slope = A.llt().solve(-dA * value);
  for (int i = 0; i < n; ++i) {
    CHECK(x[i].v == Approx(value[i]).epsilon(1e-11));
    CHECK(x[i].d[0] == Approx(slope[i]).epsilon(1e-10).margin(1e-10));
  }
}

}  // namespace symmetric_factor_test
