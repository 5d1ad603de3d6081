// Factorisation by CHOLMOD: simplicial LDLᵀ, or supernodal LLᵀ for large systems, with the approximate
// minimum degree ordering.
#include <pliant/solve/cholmod_factor.h>

#include <cholmod.h>
#include <dlfcn.h>

#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>

namespace pliant {
namespace {

/// Limits OpenBLAS, if the process has loaded it, to one thread.
void use_one_blas_thread() {
  if (void* set_threads = dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))
    reinterpret_cast<void (*)(int)>(set_threads)(1);
}

class CholmodFactor final : public SparseFactor {
 public:
  explicit CholmodFactor(const CholmodOptions& options) : options_(options) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.postorder = 1;
#if CHOLMOD_MAIN_VERSION >= 4
    common_.nthreads_max = 1;
#endif
  }
  ~CholmodFactor() override {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_, &common_);
    cholmod_free_dense(&e_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }

  Eigen::Index nonzeros() const override {
    return nonzeros_;
  }

 private:
  void do_analyse(const SparseMatrix& A) override {
    cholmod_free_factor(&factor_, &common_);
    common_.supernodal =
        A.cols() >= options_.supernodal_from && !quasi_definite() ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    cholmod_sparse view = view_of(A);
    factor_ = cholmod_analyze(&view, &common_);
    check("analysis");
    nonzeros_ = static_cast<Eigen::Index>(common_.lnz);
  }

  bool do_factor(const SparseMatrix& A) override {
    cholmod_sparse view = view_of(A);
    cholmod_factorize(&view, factor_, &common_);
    check("factorisation");
    const int* order = static_cast<const int*>(factor_->Perm);
    const std::size_t valid = factor_->minor;  // number of factored columns: all, or those before a bad pivot
    if (factor_->is_super != 0) {
      if (!accept_supernodes(order, valid)) return false;
    } else {
      const int* columns = static_cast<const int*>(factor_->p);
      const double* values = static_cast<const double*>(factor_->x);
      for (std::size_t k = 0; k < valid; ++k)
        if (!accept_pivot(order[k], values[columns[k]])) return false;
    }
    return valid == factor_->n || accept_pivot(order[valid], std::numeric_limits<double>::quiet_NaN());
  }

  /// Checks the pivots of a supernodal factor. Supernode s stores the columns super[s] … super[s+1]−1 of L as
  /// one dense block, by columns, pivot rows first.
  bool accept_supernodes(const int* order, std::size_t valid) {
    const int* super = static_cast<const int*>(factor_->super);
    const int* rows = static_cast<const int*>(factor_->pi);
    const int* blocks = static_cast<const int*>(factor_->px);
    const double* values = static_cast<const double*>(factor_->x);
    for (std::size_t s = 0; s < factor_->nsuper; ++s)
      for (int k = super[s]; k < super[s + 1] && static_cast<std::size_t>(k) < valid; ++k) {
        const int in_block = k - super[s];
        const double l = values[blocks[s] + in_block * (rows[s + 1] - rows[s]) + in_block];
        if (!accept_pivot(order[k], l * l)) return false;
      }
    return true;
  }

  void do_solve(Eigen::Ref<Eigen::MatrixXd> x) override {
    cholmod_dense b{};
    b.nrow = static_cast<std::size_t>(x.rows());
    b.ncol = static_cast<std::size_t>(x.cols());
    b.d = static_cast<std::size_t>(x.outerStride());
    b.nzmax = b.d * b.ncol;
    b.x = x.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, factor_, &b, nullptr, &x_, nullptr, &y_, &e_, &common_);
    check("solve");
    x = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
        static_cast<const double*>(x_->x), x.rows(), x.cols(), Eigen::OuterStride<>(static_cast<int>(x_->d)));
  }

  /// Returns the lower triangle of A in CHOLMOD's format. Nothing is copied; CHOLMOD does not write to A.
  static cholmod_sparse view_of(const SparseMatrix& A) {
    cholmod_sparse view{};
    view.nrow = static_cast<std::size_t>(A.rows());
    view.ncol = static_cast<std::size_t>(A.cols());
    view.nzmax = static_cast<std::size_t>(A.nonZeros());
    view.p = const_cast<int*>(A.outerIndexPtr());
    view.i = const_cast<int*>(A.innerIndexPtr());
    view.x = const_cast<double*>(A.valuePtr());
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
  }

  /// Throws if the last call of CHOLMOD failed.
  void check(const char* stage) const {
    if (common_.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common_.status < 0)
      throw std::runtime_error(std::string("sparse factor: CHOLMOD's ") + stage + " failed with status " +
                               std::to_string(common_.status));
  }

  CholmodOptions options_;
  cholmod_common common_{};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;  // workspaces of solve
  Eigen::Index nonzeros_ = 0;
};

}  // namespace

std::unique_ptr<SparseFactor> make_cholmod_factor(const CholmodOptions& options) {
  static std::once_flag once;  // several threads can call this function at the same time
  std::call_once(once, use_one_blas_thread);
  return std::make_unique<CholmodFactor>(options);
}

}  // namespace pliant
