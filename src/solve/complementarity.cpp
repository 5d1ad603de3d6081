#include <pliant/solve/complementarity.h>

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

namespace pliant {

namespace {

/// lambda of the tight rows alone, zero elsewhere; false when their block of W is singular.
bool solve_tight(const MatX<double>& W, const VecX<double>& b, const std::vector<Eigen::Index>& tight,
                 VecX<double>& lambda) {
  lambda.setZero(b.size());
  if (tight.empty()) return true;
  const auto n = static_cast<Eigen::Index>(tight.size());
  MatX<double> block(n, n);
  VecX<double> right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    right[i] = -b[tight[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < n; ++j)
      block(i, j) = W(tight[static_cast<std::size_t>(i)], tight[static_cast<std::size_t>(j)]);
  }
  const Eigen::LDLT<MatX<double>> factor(block);
  if (!(factor.vectorD().minCoeff() > 1e-12 * block.diagonal().maxCoeff())) return false;
  const VecX<double> x = factor.solve(right);
  for (Eigen::Index i = 0; i < n; ++i) lambda[tight[static_cast<std::size_t>(i)]] = x[i];
  return true;
}

}  // namespace

ComplementarityResult solve_complementarity(const MatX<double>& W, const VecX<double>& b) {
  const Eigen::Index n = b.size();
  ComplementarityResult result;
  std::vector<bool> is_tight(static_cast<std::size_t>(n), false),
      left_out(static_cast<std::size_t>(n), false);
  const double scale = std::max(b.cwiseAbs().maxCoeff(), 1e-300);
  const int most = 50 * static_cast<int>(n) + 50;
  for (; result.pivots < most; ++result.pivots) {
    std::vector<Eigen::Index> tight;
    for (Eigen::Index i = 0; i < n; ++i)
      if (is_tight[static_cast<std::size_t>(i)]) tight.push_back(i);
    if (!solve_tight(W, b, tight, result.lambda)) {
      // The row that came in last made the block singular: the others carry it.
      is_tight[static_cast<std::size_t>(tight.back())] = false;
      left_out[static_cast<std::size_t>(tight.back())] = true;
      continue;
    }
    const VecX<double> slack = W * result.lambda + b;
    Eigen::Index change = -1;
    for (Eigen::Index i = 0; i < n && change < 0; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (is_tight[k] ? result.lambda[i] < 0 : (!left_out[k] && slack[i] < -1e-14 * scale)) change = i;
    }
    if (change < 0) break;
    const auto k = static_cast<std::size_t>(change);
    is_tight[k] = !is_tight[k];
  }
  const VecX<double> slack = W * result.lambda + b;
  for (Eigen::Index i = 0; i < n; ++i) {
    result.residual = std::max({result.residual, -slack[i], -result.lambda[i] * W(i, i)});
    result.residual = std::max(result.residual, std::min(result.lambda[i] * W(i, i), slack[i]));
  }
  return result;
}

}  // namespace pliant
