// An interface for sparse factorisations of symmetric matrices: A = Pᵀ L D Lᵀ P with a fill-reducing ordering
// P (AMD). A is positive definite, or it is quasi-definite: the block of its first rows is positive definite
// and the block of the other rows is negative definite. The matrix of Eq. (14) with a small negative diagonal
// as its lower block is quasi-definite. D is positive in the first rows and negative in the others. The
// pattern is analysed once; the values are factored each time they change. The core library contains Eigen's
// factorisation; pliant::suitesparse adds CHOLMOD's (solve/cholmod_factor.h).
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <Eigen/SparseCore>

namespace pliant {

/// A sparse matrix by compressed columns. The factorisations read only the lower triangle.
using SparseMatrix = Eigen::SparseMatrix<double>;

/// The pivot at which a factorisation stopped.
struct BadPivot {
  Eigen::Index row;  ///< the row and column of A, in the order of A
  double value;      ///< the pivot, D(row); NaN if the factorisation does not report it
  double diagonal;   ///< A(row, row), the scale of the pivot
};

/// One factorisation. Not thread-safe: factor() and solve() use workspaces of the object.
class SparseFactor {
 public:
  virtual ~SparseFactor() = default;
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  /// Computes the ordering and the symbolic factorisation for the pattern of a positive definite A. The
  /// values of A are not read. Throws std::invalid_argument unless A is square and compressed and its pattern
  /// contains the whole diagonal.
  void analyse(const SparseMatrix& A) { analyse(A, A.rows()); }
  /// Analyses a quasi-definite matrix whose rows from n_positive on are negative definite.
  void analyse(const SparseMatrix& A, Eigen::Index n_positive);

  /// Computes the numeric factorisation of A. Throws std::invalid_argument if A does not have the analysed
  /// pattern. Returns false if a pivot is not finite, has the wrong sign, or is at most kPivotTolerance
  /// |A(row, row)| in absolute value. The right sign is - for rows from n_positive on and + for other rows.
  /// After a failure bad_pivot() returns the first bad pivot in the order of elimination.
  [[nodiscard]] bool factor(const SparseMatrix& A);

  /// Overwrites each column b of x with A⁻¹ b. x has as many rows as A. Throws std::logic_error unless the
  /// last factor() succeeded, and std::invalid_argument if x has another number of rows.
  void solve(Eigen::Ref<Eigen::MatrixXd> x);

  /// Returns the pivots, in the order of the rows of A. Valid after a factor() that succeeded.
  const std::vector<double>& pivots() const { return pivots_; }
  /// Returns the pivot at which the last factor() stopped. Valid after a factor() that failed.
  const BadPivot& bad_pivot() const { return bad_pivot_; }
  /// Returns the number of rows of the analysed matrix.
  Eigen::Index size() const { return static_cast<Eigen::Index>(diagonal_.size()); }
  /// Returns the number of entries of L, including its diagonal. Valid after a factor() that succeeded.
  virtual Eigen::Index nonzeros() const = 0;

  /// A pivot of at most this fraction of its diagonal entry is treated as zero. The pivot of a redundant row
  /// is zero in exact arithmetic, but small and nonzero because of rounding.
  static constexpr double kPivotTolerance = 1e-13;

 protected:
  SparseFactor() = default;
  /// Stores the pivot of a row of A for pivots(). Returns whether the pivot is finite, has the sign of the
  /// row and is large enough. A pivot that is not accepted is also stored for bad_pivot().
  bool accept_pivot(Eigen::Index row, double pivot);
  bool quasi_definite() const { return n_positive_ < size(); }

 private:
  virtual void do_analyse(const SparseMatrix& A) = 0;
  /// Factors A and calls accept_pivot in the order of elimination. Returns whether all pivots were accepted;
  /// stops at the first pivot that was not accepted.
  virtual bool do_factor(const SparseMatrix& A) = 0;
  virtual void do_solve(Eigen::Ref<Eigen::MatrixXd> x) = 0;

  std::vector<int> columns_, rows_;  // the analysed pattern
  std::vector<double> diagonal_;     // the diagonal of the matrix factored last
  std::vector<double> pivots_;
  Eigen::Index n_positive_ = 0;
  BadPivot bad_pivot_{};
  bool factored_ = false;
};

/// Returns a factorisation by Eigen's simplicial LDLᵀ, which is faster than CHOLMOD below some thousand
/// unknowns.
std::unique_ptr<SparseFactor> make_eigen_factor();

/// Makes a new, empty factorisation.
using MakeSparseFactor = std::function<std::unique_ptr<SparseFactor>()>;

}  // namespace pliant
