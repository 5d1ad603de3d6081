// The checks that all sparse factorisations share: patterns, pivots, the order of calls.
#include <pliant/math/sparse_factor.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace pliant {

void SparseFactor::analyse(const SparseMatrix& A, Eigen::Index n_positive) {
  if (A.rows() != A.cols() || !A.isCompressed())
    throw std::invalid_argument("sparse factor: the matrix must be square and compressed");
  const int* columns = A.outerIndexPtr();
  const int* rows = A.innerIndexPtr();
  for (int j = 0; j < A.cols(); ++j)
    if (!std::binary_search(rows + columns[j], rows + columns[j + 1], j))
      throw std::invalid_argument("sparse factor: entry (" + std::to_string(j) + ", " + std::to_string(j) +
                                  ") of the diagonal is not in the pattern");
  factored_ = false;
  columns_.assign(columns, columns + A.cols() + 1);
  rows_.assign(rows, rows + A.nonZeros());
  diagonal_.assign(static_cast<std::size_t>(A.cols()), 0.0);
  pivots_.assign(static_cast<std::size_t>(A.cols()), 0.0);
  n_positive_ = n_positive;
  do_analyse(A);
}

bool SparseFactor::factor(const SparseMatrix& A) {
  factored_ = false;
  if (A.cols() != size() || A.rows() != size() || !A.isCompressed() ||
      A.nonZeros() != static_cast<Eigen::Index>(rows_.size()) ||
      !std::equal(columns_.begin(), columns_.end(), A.outerIndexPtr()) ||
      !std::equal(rows_.begin(), rows_.end(), A.innerIndexPtr()))
    throw std::invalid_argument("sparse factor: the pattern of the matrix differs from the analysed pattern");
  if (columns_.empty()) throw std::invalid_argument("sparse factor: no pattern was analysed");
  for (int j = 0; j < A.cols(); ++j) {
    const auto begin = rows_.begin() + columns_[static_cast<std::size_t>(j)];
    const auto end = rows_.begin() + columns_[static_cast<std::size_t>(j) + 1];
    diagonal_[static_cast<std::size_t>(j)] = A.valuePtr()[std::lower_bound(begin, end, j) - rows_.begin()];
  }
  return factored_ = do_factor(A);
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): a Ref is passed by value to be written through
void SparseFactor::solve(Eigen::Ref<Eigen::MatrixXd> x) {
  if (!factored_) throw std::logic_error("sparse factor: solve() was called without a successful factor()");
  if (x.rows() != size())
    throw std::invalid_argument("sparse factor: the right-hand side has " + std::to_string(x.rows()) +
                                " rows, the matrix " + std::to_string(size()));
  do_solve(x);
}

bool SparseFactor::accept_pivot(Eigen::Index row, double pivot) {
  const double diagonal = diagonal_[static_cast<std::size_t>(row)];
  const double size = row < n_positive_ ? pivot : -pivot;
  pivots_[static_cast<std::size_t>(row)] = pivot;
  if (size > 0 && size > kPivotTolerance * std::abs(diagonal) && std::isfinite(pivot)) return true;
  bad_pivot_ = {row, pivot, diagonal};
  return false;
}

}  // namespace pliant
