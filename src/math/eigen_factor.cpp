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
    ldlt_.factorize(A);  // stops at a pivot that is exactly zero only; the pivots before it are valid
    const Eigen::VectorXd pivots = ldlt_.vectorD();
    for (Eigen::Index k = 0; k < pivots.size(); ++k)
      if (!accept_pivot(ldlt_.permutationPinv().indices()[k], pivots[k])) return false;
    return true;
  }

  void do_solve(Eigen::Ref<Eigen::MatrixXd> x) override { x = ldlt_.solve(x).eval(); }

  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt_;
};

}  // namespace

std::unique_ptr<SparseFactor> make_eigen_factor() {
  return std::make_unique<EigenFactor>();
}

}  // namespace pliant
