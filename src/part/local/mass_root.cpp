// Square roots of mass matrices by sparse Cholesky factors.
#include "mass_root.h"

#include <stdexcept>

namespace pliant {

MassRoot::MassRoot(Eigen::SparseMatrix<double> nodes, const VecX<double>& own)
    : M_(std::move(nodes)), factor_(M_), own_(own.cwiseSqrt()) {
  if (factor_.info() != Eigen::Success)
    throw std::invalid_argument("its mass matrix is not positive definite");
}

// The factorisation is P M P^T = L L^T with a permutation P. Therefore C = L^T P.

MatX<double> MassRoot::root_of_nodes(const MatX<double>& d) const {
  return factor_.matrixU() * MatX<double>(factor_.permutationP() * d);
}

MatX<double> MassRoot::solve_of_nodes(const MatX<double>& x) const {
  return factor_.permutationPinv() * MatX<double>(factor_.matrixU().solve(x));
}

template <class Nodal, class Own>
MatX<double> MassRoot::each(const MatX<double>& all, Nodal&& nodal, Own&& own) const {
  const Eigen::Index n = n_nodes();
  MatX<double> result(all.rows(), all.cols());
  for (int r = 0; r < 3; ++r) result.middleRows(r * n, n) = nodal(MatX<double>(all.middleRows(r * n, n)));
  result.bottomRows(own_.size()) = own(all.bottomRows(own_.size()));
  return result;
}

MatX<double> MassRoot::root(const MatX<double>& d) const {
  return each(
      d, [&](const MatX<double>& rows) { return root_of_nodes(rows); },
      [&](const auto& rows) { return own_.asDiagonal() * rows; });
}

MatX<double> MassRoot::transposed(const MatX<double>& x) const {
  return each(
      x,
      [&](const MatX<double>& rows) -> MatX<double> {
        return factor_.permutationPinv() * MatX<double>(factor_.matrixL() * rows);
      },
      [&](const auto& rows) { return own_.asDiagonal() * rows; });
}

MatX<double> MassRoot::solve(const MatX<double>& x) const {
  return each(
      x, [&](const MatX<double>& rows) { return solve_of_nodes(rows); },
      [&](const auto& rows) { return own_.cwiseInverse().asDiagonal() * rows; });
}

Eigen::SparseMatrix<double> MassRoot::whole() const {
  const Eigen::Index n = n_nodes();
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index c = 0; c < M_.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator at(M_, c); at; ++at)
      for (int r = 0; r < 3; ++r)
        entries.emplace_back(static_cast<int>(at.row() + r * n), static_cast<int>(at.col() + r * n),
                             at.value());
  for (Eigen::Index k = 0; k < own_.size(); ++k)
    entries.emplace_back(static_cast<int>(3 * n + k), static_cast<int>(3 * n + k), own_[k] * own_[k]);
  Eigen::SparseMatrix<double> M(size(), size());
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

}  // namespace pliant
