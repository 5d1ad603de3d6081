// Eigen's simplicial LDLᵀ with its approximate minimum degree ordering.
#include <Eigen/SparseCholesky>

#include <pliant/math/sparse_factor.h>

namespace pliant {
namespace {

class EigenFactor final : public SparseFactor {
 public:
  Eigen::Index nonzeros() const override { return ldlt_.matrixL().nestedExpression().nonZeros() + size(); }

 private:
  void do_analyse(const SparseMatrix& A) override { ldlt_.analyzePattern(A); }

  bool do_factor(const SparseMatrix& A) override {
    ldlt_.factorize(A);  // a zero pivot ends factorize() early; the pivots before it are valid
    const Eigen::VectorXd pivots = ldlt_.vectorD();
    for (Eigen::Index k = 0; k < pivots.size(); ++k)
      if (!accept_pivot(ldlt_.permutationPinv().indices()[k], pivots[k])) return false;
    return true;
  }

  /// Solves for several right-hand sides together. The right-hand sides are the rows of y_, so that each
  /// entry of L is loaded only twice.
  void do_solve(Eigen::Ref<Eigen::MatrixXd> x) override {
    if (x.cols() == 1) {
      x = ldlt_.solve(x).eval();
      return;
    }
    const SparseMatrix& L = ldlt_.matrixL().nestedExpression();
    const Eigen::VectorXd pivots = ldlt_.vectorD();
    y_ = (ldlt_.permutationP() * x).transpose();
    for (int j = 0; j < size(); ++j) {
      for (SparseMatrix::InnerIterator entry(L, j); entry; ++entry)
        y_.col(entry.row()) -= entry.value() * y_.col(j);
    }
    for (int j = static_cast<int>(size()); j-- > 0;) {
      y_.col(j) /= pivots[j];
      for (SparseMatrix::InnerIterator entry(L, j); entry; ++entry)
        y_.col(j) -= entry.value() * y_.col(entry.row());
    }
    x = ldlt_.permutationPinv() * y_.transpose();
  }

  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt_;
  Eigen::MatrixXd y_;
};

}  // namespace

std::unique_ptr<SparseFactor> make_eigen_factor() {
  return std::make_unique<EigenFactor>();
}

}  // namespace pliant
