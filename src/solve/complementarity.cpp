#include <pliant/solve/complementarity.h>

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

namespace pliant {

namespace {

/// Rounding of a row, in units of its terms; a row that is open by no more than this is met.
constexpr double kRounding = 1e-14;
/// A row that adds less than this part of its own diagonal to the tight ones depends on them.
constexpr double kDependent = 1e-12;

class ActiveSet {
 public:
  ActiveSet(const MatX<double>& W, const VecX<double>& b)
      : W_(W),
        b_(b),
        lambda_(VecX<double>::Zero(b.size())),
        out_(static_cast<std::size_t>(b.size()), false) {}

  /// The row that is open most, in the metric of W; -1 when none is.
  Eigen::Index most_open() const {
    Eigen::Index worst = -1;
    double most = 0;
    for (Eigen::Index i = 0; i < b_.size(); ++i) {
      if (out_[static_cast<std::size_t>(i)] || !(W_(i, i) > 0)) continue;
      double slack = b_[i], terms = std::abs(b_[i]);
      for (const Eigen::Index j : tight_) {
        slack += W_(i, j) * lambda_[j];
        terms += std::abs(W_(i, j) * lambda_[j]);
      }
      const double open = slack < -kRounding * terms ? slack * slack / W_(i, i) : 0;
      if (open > most && std::find(tight_.begin(), tight_.end(), i) == tight_.end()) {
        worst = i;
        most = open;
      }
    }
    return worst;
  }

  /// Makes row j tight; other rows may come loose on the way. Returns the number of systems solved.
  int tighten(Eigen::Index j) {
    for (int solved = 1;; ++solved) {
      // W_PP y = W_Pj: what a unit impulse of row j takes from the others.
      const auto n = static_cast<Eigen::Index>(tight_.size());
      const MatX<double> block = W_(tight_, tight_);
      const Eigen::LDLT<MatX<double>> factor(block);
      const VecX<double> y = n > 0 ? VecX<double>(factor.solve(W_(tight_, j))) : VecX<double>();
      double pivot = W_(j, j), slack = b_[j] + W_(j, j) * lambda_[j];
      for (Eigen::Index k = 0; k < n; ++k) {
        const Eigen::Index i = tight_[static_cast<std::size_t>(k)];
        pivot -= W_(j, i) * y[k];
        slack += W_(j, i) * lambda_[i];
      }
      // As far as the row closes, or as the first of the others comes loose.
      const bool dependent = !(pivot > kDependent * W_(j, j));
      double reach = dependent ? -1 : std::max(0.0, -slack / pivot);
      Eigen::Index loose = -1;
      for (Eigen::Index k = 0; k < n; ++k) {
        if (!(y[k] > 0)) continue;
        const double until = lambda_[tight_[static_cast<std::size_t>(k)]] / y[k];
        if (reach < 0 || until < reach) {
          reach = until;
          loose = k;
        }
      }
      if (reach < 0) {  // it contradicts the tight rows: no impulse closes it
        out_[static_cast<std::size_t>(j)] = true;
        release(j);
        return solved;
      }
      lambda_[j] += reach;
      for (Eigen::Index k = 0; k < n; ++k) lambda_[tight_[static_cast<std::size_t>(k)]] -= reach * y[k];
      if (loose < 0) {
        tight_.push_back(j);
        refine();
        return solved;
      }
      release(tight_[static_cast<std::size_t>(loose)]);
    }
  }

  const VecX<double>& lambda() const { return lambda_; }

 private:
  void release(Eigen::Index i) {
    lambda_[i] = 0;
    tight_.erase(std::remove(tight_.begin(), tight_.end(), i), tight_.end());
  }
  /// The impulses of the tight rows anew, so that rounding does not pile up over many changes.
  void refine() {
    const MatX<double> block = W_(tight_, tight_);
    const VecX<double> x = Eigen::LDLT<MatX<double>>(block).solve(-b_(tight_));
    for (std::size_t k = 0; k < tight_.size(); ++k)
      lambda_[tight_[k]] = std::max(0.0, x[static_cast<Eigen::Index>(k)]);
  }

  const MatX<double>& W_;
  const VecX<double>& b_;
  VecX<double> lambda_;
  std::vector<Eigen::Index> tight_;
  std::vector<bool> out_;
};

}  // namespace

ComplementarityResult solve_complementarity(const MatX<double>& W, const VecX<double>& b) {
  const Eigen::Index n = b.size();
  ComplementarityResult result;
  ActiveSet rows(W, b);
  const int most = 50 * static_cast<int>(n) + 50;
  for (Eigen::Index next = rows.most_open(); next >= 0 && result.pivots < most; next = rows.most_open())
    result.pivots += rows.tighten(next);
  result.lambda = rows.lambda();
  const VecX<double> slack = W * result.lambda + b;
  for (Eigen::Index i = 0; i < n; ++i) {
    result.residual = std::max({result.residual, -slack[i], -result.lambda[i] * W(i, i)});
    result.residual = std::max(result.residual, std::min(result.lambda[i] * W(i, i), slack[i]));
  }
  return result;
}

}  // namespace pliant
