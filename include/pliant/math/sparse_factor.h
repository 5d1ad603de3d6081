// Sparse Cholesky factorisation of symmetric matrices, behind one face: A = Pᵀ L D Lᵀ P with a fill-reducing
// ordering P (AMD). A is positive definite, or quasi-definite: positive definite in its first rows, negative
// definite in the others, as Eq. (14) is with a small -δI below; then D has the signs of these rows. The
// pattern is analysed once, values are factored as often as they change. Eigen's own factorisation is in
// core; CHOLMOD's is the library pliant::suitesparse (solve/cholmod_factor.h).
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <Eigen/SparseCore>

namespace pliant {

/// Columns compressed; of a symmetric matrix only the lower triangle is read.
using SparseMatrix = Eigen::SparseMatrix<double>;

/// The pivot at which a factorisation stopped.
struct BadPivot {
  Eigen::Index row;  ///< the row and column of A, in A's own order
  double value;      ///< the pivot, D(row); NaN when the method does not tell
  double diagonal;   ///< A(row, row), which the pivot is judged by
};

/// One factorisation. Not for several threads at once: factoring and solving use workspaces of the object.
class SparseFactor {
 public:
  virtual ~SparseFactor() = default;
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  /// Ordering and symbolic factorisation for the pattern of A; its values are not read. Diagonal entries must
  /// be there. Throws std::invalid_argument unless A is square, compressed and has its whole diagonal.
  void analyse(const SparseMatrix& A) { analyse(A, A.rows()); }
  /// The same of a quasi-definite matrix whose rows from n_positive on are negative definite.
  void analyse(const SparseMatrix& A, Eigen::Index n_positive);

  /// Numeric factorisation of A, whose pattern is the analysed one (else std::invalid_argument).
  /// False when A is not safely definite: a pivot, with the sign that its row is to have, is not above
  /// kPivotTolerance times the size of the diagonal entry it began as, or is not finite; bad_pivot() then
  /// names the first in the order of elimination.
  [[nodiscard]] bool factor(const SparseMatrix& A);

  /// Overwrites each column of x, a right-hand side b, with A⁻¹ b. Throws std::logic_error unless the last
  /// factor() succeeded, std::invalid_argument when x has not n rows.
  void solve(Eigen::Ref<Eigen::MatrixXd> x);

  /// The pivots of a factor() that succeeded, in the order of A's rows.
  const std::vector<double>& pivots() const { return pivots_; }
  /// Where the last factor() stopped; meaningless after one that succeeded.
  const BadPivot& bad_pivot() const { return bad_pivot_; }
  /// Rows of the analysed matrix.
  Eigen::Index size() const { return static_cast<Eigen::Index>(diagonal_.size()); }
  /// Entries of L, its diagonal included; known after a factor() that succeeded.
  virtual Eigen::Index nonzeros() const = 0;

  /// Rounding leaves a redundant row a pivot of this size, relative to its diagonal entry, instead of zero.
  static constexpr double kPivotTolerance = 1e-13;

 protected:
  SparseFactor() = default;
  /// Whether a pivot that began as the diagonal entry of a row (of A) is good; keeps it as the bad one
  /// otherwise.
  bool accept_pivot(Eigen::Index row, double pivot);
  bool quasi_definite() const { return n_positive_ < size(); }

 private:
  virtual void do_analyse(const SparseMatrix& A) = 0;
  /// Calls accept_pivot in the order of elimination until it refuses, and returns whether it never did.
  virtual bool do_factor(const SparseMatrix& A) = 0;
  virtual void do_solve(Eigen::Ref<Eigen::MatrixXd> x) = 0;

  std::vector<int> columns_, rows_;  // the analysed pattern
  std::vector<double> diagonal_;     // of the matrix last factored
  std::vector<double> pivots_;
  Eigen::Index n_positive_ = 0;
  BadPivot bad_pivot_{};
  bool factored_ = false;
};

/// Eigen's simplicial LDLᵀ: the faster one below some thousand unknowns.
std::unique_ptr<SparseFactor> make_eigen_factor();

using MakeSparseFactor = std::function<std::unique_ptr<SparseFactor>()>;

}  // namespace pliant
