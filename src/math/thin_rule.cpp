// Thinning of a quadrature rule by elimination along null vectors of F^T, the transpose of the matrix of the
// contributions F(i, k) of the nodes.
#include <pliant/math/thin_rule.h>

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/QR>

namespace pliant {

namespace {

/// Moves x >= 0 along the null vectors (columns of Z) until one entry of x per null vector is zero. x stays
/// >= 0.
void eliminate(Eigen::VectorXd& x, Eigen::MatrixXd& Z) {
  constexpr double far = std::numeric_limits<double>::infinity();
  for (Eigen::Index left = Z.cols(); left > 0; --left) {
    auto z = Z.col(left - 1);
    // Find the first entry that vanishes in the direction -z (index 0) and in the direction z (index 1). Of
    // these two entries, the entry with the larger pivot |z_i| is eliminated, because this is more stable.
    Eigen::Index pivot[2] = {-1, -1};
    double reach[2] = {far, far};
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (z[i] == 0) continue;
      const int way = z[i] > 0 ? 0 : 1;
      const double t = x[i] / std::abs(z[i]);
      if (t < reach[way]) {
        reach[way] = t;
        pivot[way] = i;
      }
    }
    int way = 0;
    if (pivot[0] < 0 || (pivot[1] >= 0 && std::abs(z[pivot[1]]) > std::abs(z[pivot[0]]))) way = 1;
    const Eigen::Index out = pivot[way];
    if (out < 0) continue;
    x -= (way == 0 ? reach[0] : -reach[1]) * z;
    x = x.cwiseMax(0.0);
    x[out] = 0;
    const Eigen::RowVectorXd share = Z.row(out).head(left - 1) / z[out];
    Z.leftCols(left - 1).noalias() -= z * share;
    Z.row(out).head(left - 1).setZero();
  }
}

}  // namespace

Eigen::VectorXd thin_rule(const Eigen::MatrixXd& F, Eigen::Index* rank_found, double tolerance) {
  const Eigen::Index n = F.rows();
  // Divide each column by the sum of its absolute values. Then divide each row i by d_i, the square root of
  // its norm, and multiply the factor c_i by d_i. The unknowns are thus x_i = d_i c_i. The unknowns behave
  // like square roots of weights, because the norm of a row has the weight of its node as a factor.
  Eigen::MatrixXd A = F;
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    const double sum = A.col(k).cwiseAbs().sum();
    if (sum > 0) A.col(k) /= sum;
  }
  const Eigen::VectorXd d = A.rowwise().norm().cwiseSqrt();
  for (Eigen::Index i = 0; i < n; ++i)
    if (d[i] > 0) A.row(i) /= d[i];

  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  const auto R = qr.matrixQR().diagonal().cwiseAbs();
  Eigen::Index rank = 0;
  while (rank < R.size() && R[rank] > tolerance * R[0]) ++rank;
  if (rank_found) *rank_found = rank;
  if (rank >= n) return Eigen::VectorXd::Ones(n);

  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd Z = Q.rightCols(n - rank);
  Eigen::VectorXd x = d;
  eliminate(x, Z);

  // Correct the rounding errors of the eliminations on the remaining nodes.
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n; ++i)
    if (x[i] > 0) kept.push_back(i);
  const auto U = Q.leftCols(rank);
  const Eigen::VectorXd wanted = U.transpose() * d;
  Eigen::MatrixXd on_kept(rank, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i)
    on_kept.col(static_cast<Eigen::Index>(i)) = U.row(kept[i]).transpose();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(on_kept);
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::VectorXd correction = solver.solve(wanted - U.transpose() * x);
    for (std::size_t i = 0; i < kept.size(); ++i)
      x[kept[i]] = std::max(0.0, x[kept[i]] + correction[static_cast<Eigen::Index>(i)]);
  }
  Eigen::VectorXd c = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i : kept)
    if (d[i] > 0) c[i] = x[i] / d[i];
  return c;
}

}  // namespace pliant
