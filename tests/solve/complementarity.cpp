// The complementarity solver against enumeration of all active sets.
#include "catch.h"

#include <cmath>

#include <Eigen/LU>
#include <Eigen/QR>

#include <pliant/solve/complementarity.h>

#include "draws.h"

namespace complementarity_test {

using namespace pliant;
using test::Draws;

namespace {

/// Returns the impulses of the first active set for which impulses and velocities W lambda + b are not
/// negative; empty if there is no such set.
VecX<double> by_enumeration(const MatX<double>& W, const VecX<double>& b) {
  const Eigen::Index n = b.size();
  const double scale = b.cwiseAbs().maxCoeff();
  for (int set = 0; set < 1 << n; ++set) {
    std::vector<Eigen::Index> active;
    for (Eigen::Index i = 0; i < n; ++i)
      if ((set >> i & 1) != 0) active.push_back(i);
    VecX<double> lambda = VecX<double>::Zero(n);
    if (!active.empty()) {
      const MatX<double> block = W(active, active);
      const VecX<double> x = block.completeOrthogonalDecomposition().solve(-b(active));
      if ((block * x + b(active)).norm() > 1e-10 * scale) continue;
      lambda(active) = x;
    }
    const VecX<double> slack = W * lambda + b;
    if ((lambda.array() * W.diagonal().array()).minCoeff() >= -1e-10 * scale &&
        slack.minCoeff() >= -1e-10 * scale)
      return lambda;
  }
  return {};
}

MatX<double> random_matrix(Draws& draws, int rows, int columns) {
  MatX<double> A(rows, columns);
  for (Eigen::Index i = 0; i < A.size(); ++i) A.data()[i] = draws.uniform(-1, 1);
  return A;
}
VecX<double> random_vector(Draws& draws, int n) {
  return random_matrix(draws, n, 1);
}

}  // namespace

TEST_CASE("random positive definite problems: impulses agree with enumeration", "[solve]") {
  Draws draws(1);
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + trial % 8;
    const MatX<double> C = random_matrix(draws, n, n + 2);
    const MatX<double> W = C * C.transpose();
    const VecX<double> b = random_vector(draws, n);
    const ComplementarityResult<> result = solve_complementarity(W, b);
    const VecX<double> expected = by_enumeration(W, b);
    REQUIRE(expected.size() == n);
    CHECK((result.lambda - expected).norm() <= 1e-8 * (1 + expected.norm()));
    CHECK(result.residual <= 1e-12 * (1 + W.cwiseAbs().maxCoeff() * expected.norm()));
  }
}

TEST_CASE("rank-deficient problems: velocities agree with enumeration, impulses are not negative",
          "[solve]") {
  Draws draws(2);
  for (int trial = 0; trial < 600; ++trial) {
    const int n = 2 + trial % 6, rank = 1 + trial % (n - 1);
    MatX<double> C = random_matrix(draws, n, rank);
    if (trial % 3 == 0) C.row(n - 1) = C.row(0);  // two equal rows
    const MatX<double> W = C * C.transpose();
    const VecX<double> b = C * random_vector(draws, rank);  // a solvable right-hand side
    const ComplementarityResult<> result = solve_complementarity(W, b);
    INFO("n " << n << " rank " << rank << " pivots " << result.pivots << "\nW\n"
              << W << "\nb " << b.transpose());
    CHECK(result.lambda.minCoeff() >= -1e-12);
    CHECK(result.residual <= 1e-10);
    const VecX<double> expected = by_enumeration(W, b);
    if (expected.size() == n) CHECK((W * (result.lambda - expected)).norm() <= 1e-8);
  }
}

TEST_CASE("results scale exactly with powers of two", "[solve]") {
  Draws draws(3);
  for (double scale : {0x1p-200, 0x1p-20, 0x1p20, 0x1p200}) {
    const MatX<double> C = random_matrix(draws, 5, 7);
    const MatX<double> W = C * C.transpose();
    const VecX<double> b = random_vector(draws, 5);
    const VecX<double> lambda = solve_complementarity(W, b).lambda;
    CHECK(solve_complementarity(W, VecX<double>(scale * b)).lambda == scale * lambda);
    CHECK(solve_complementarity(MatX<double>(scale * W), b).lambda == lambda / scale);
  }
}

TEST_CASE("problems without impulses and empty problems", "[solve]") {
  const MatX<double> I = MatX<double>::Identity(3, 3);
  CHECK(solve_complementarity(I, VecX<double>(VecX<double>::Ones(3))).lambda.norm() == 0);
  CHECK(solve_complementarity(I, VecX<double>(VecX<double>::Zero(3))).lambda.norm() == 0);
  CHECK(solve_complementarity(MatX<double>(0, 0), VecX<double>(0)).lambda.size() == 0);
}

TEST_CASE("bounded storage without the heap gives equal impulses", "[solve]") {
  Draws draws(4);
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 1 + trial % 8;
    const MatX<double> C = random_matrix(draws, n, n + 1);
    const MatX<double> W = C * C.transpose();
    const VecX<double> b = random_vector(draws, n);
    const MatMax<double, kMaxLimitRows> W_bounded = W;
    const VecMax<double, kMaxLimitRows> b_bounded = b;
    CHECK(VecX<double>(solve_complementarity(W_bounded, b_bounded).lambda) ==
          solve_complementarity(W, b).lambda);
  }
}

}  // namespace complementarity_test
