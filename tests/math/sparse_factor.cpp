// The sparse factorisations of Eigen and of CHOLMOD (simplicial and supernodal): their solutions are
// accurate, and a factorisation that fails reports the row of the bad pivot.
#include <pliant/math/sparse_factor.h>
#include <pliant/solve/cholmod_factor.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "catch.h"

namespace sparse_factor_test {

namespace {

using pliant::SparseFactor;
using pliant::SparseMatrix;
using Triplets = std::vector<Eigen::Triplet<double>>;

struct Backend {
  std::string name;
  std::function<std::unique_ptr<SparseFactor>()> make;
};

std::vector<Backend> backends() {
  return {{"Eigen", [] { return pliant::make_eigen_factor(); }},
          {"CHOLMOD simplicial", [] { return pliant::make_cholmod_factor({1 << 30}); }},
          {"CHOLMOD supernodal", [] { return pliant::make_cholmod_factor({0}); }}};
}

/// Returns the lower triangle of the n x n stiffness matrix of a net of springs. 2 n springs of random
/// stiffness connect random pairs of n nodes, and a spring of stiffness 0.5 connects each node to the ground.
SparseMatrix spring_net(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> point(0, n - 1);
  std::uniform_real_distribution<double> strength(0.1, 10);
  Triplets entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 0.5);
  for (int link = 0; link < 2 * n; ++link) {
    const int i = point(random), j = point(random);
    const double k = strength(random);
    if (i == j) continue;
    entries.emplace_back(i, i, k);
    entries.emplace_back(j, j, k);
    entries.emplace_back(std::max(i, j), std::min(i, j), -k);
  }
  SparseMatrix A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// Returns the lower triangle of a matrix.
SparseMatrix lower(const Eigen::MatrixXd& dense) {
  Triplets entries;
  for (int j = 0; j < dense.cols(); ++j)
    for (int i = j; i < dense.rows(); ++i) entries.emplace_back(i, j, dense(i, j));
  SparseMatrix A(dense.rows(), dense.cols());
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace

TEST_CASE("solutions of a random net of springs are accurate") {
  const int n = 400;
  const SparseMatrix first = spring_net(n, 1);
  SparseMatrix A = first;
  const Eigen::MatrixXd b = Eigen::MatrixXd::Random(n, 3);
  for (const Backend& backend : backends()) {
    CAPTURE(backend.name);
    const auto factor = backend.make();
    factor->analyse(first);
    CHECK(factor->size() == n);
    for (const double scale : {1.0, 7.0}) {  // new values, unchanged pattern
      A.coeffs() = scale * first.coeffs();
      REQUIRE(factor->factor(A));
      Eigen::MatrixXd x = b;
      factor->solve(x);
      const Eigen::MatrixXd residual = A.selfadjointView<Eigen::Lower>() * x - b;
      CHECK(residual.norm() < 1e-13 * b.norm() * n);
      CHECK(factor->nonzeros() >= A.nonZeros());
    }
    Eigen::VectorXd one = b.col(0);
    factor->solve(one);
    const Eigen::VectorXd residual = A.selfadjointView<Eigen::Lower>() * one - b.col(0);
    CHECK(residual.norm() < 1e-13 * b.norm() * n);
  }
}

TEST_CASE("a pivot that fails is reported with its row") {
  Eigen::MatrixXd good = Eigen::MatrixXd::Identity(6, 6) * 2;
  good(1, 0) = good(0, 1) = 0.5;
  for (const Backend& backend : backends()) {
    CAPTURE(backend.name);
    const auto factor = backend.make();
    SparseMatrix A = lower(good);
    factor->analyse(A);
    SECTION(backend.name + ": negative") {
      A.coeffRef(4, 4) = -3;
      CHECK_FALSE(factor->factor(A));
      CHECK(factor->bad_pivot().row == 4);
      CHECK(factor->bad_pivot().diagonal == -3);
    }
    SECTION(backend.name + ": zero") {
      A.coeffRef(3, 3) = 0;
      CHECK_FALSE(factor->factor(A));
      CHECK(factor->bad_pivot().row == 3);
    }
    SECTION(backend.name + ": not a number") {
      A.coeffRef(2, 2) = std::numeric_limits<double>::quiet_NaN();
      CHECK_FALSE(factor->factor(A));
      CHECK(factor->bad_pivot().row == 2);
    }
    SECTION(backend.name + ": a row that is a multiple of another one leaves a pivot of rounding size") {
      A.coeffRef(1, 0) = 0.3;
      A.coeffRef(0, 0) = 0.1;
      A.coeffRef(1, 1) = 0.9;
      CHECK_FALSE(factor->factor(A));
      const auto row = factor->bad_pivot().row;
      CHECK((row == 0 || row == 1));
    }
    Eigen::MatrixXd x = good;
    CHECK_THROWS_AS(factor->solve(x), std::logic_error);
    REQUIRE(factor->factor(lower(good)));  // The factor can be used again with valid values.
    factor->solve(x);
    CHECK((x - Eigen::MatrixXd::Identity(6, 6)).norm() < 1e-14);
  }
}

TEST_CASE("misuse of a factorisation is refused") {
  for (const Backend& backend : backends()) {
    CAPTURE(backend.name);
    const auto factor = backend.make();
    const SparseMatrix A = spring_net(20, 2);
    Eigen::VectorXd b = Eigen::VectorXd::Ones(20);
    CHECK_THROWS_AS(factor->factor(A), std::invalid_argument);
    CHECK_THROWS_AS(factor->solve(b), std::logic_error);
    factor->analyse(A);
    CHECK_THROWS_AS(factor->solve(b), std::logic_error);
    CHECK_THROWS_AS(factor->factor(spring_net(20, 3)), std::invalid_argument);
    CHECK_THROWS_AS(factor->analyse(SparseMatrix(3, 4)), std::invalid_argument);
    CHECK_THROWS_AS(factor->analyse(SparseMatrix(3, 3)), std::invalid_argument);
    REQUIRE(factor->factor(A));
    Eigen::VectorXd longer = Eigen::VectorXd::Ones(21);
    CHECK_THROWS_AS(factor->solve(longer), std::invalid_argument);
  }
}

}  // namespace sparse_factor_test
