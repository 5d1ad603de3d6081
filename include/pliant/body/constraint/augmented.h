// The augmented matrix of Eq. (14) for the joints of an island,
//   [ M    C_q^T ]
//   [ C_q   -d I ]
// It is sparse. A small d makes it quasi-definite, so that dependent rows of C_q do no harm; iterative
// refinement removes the error of d for all other rows. The result is W_c^-1 for W_c = C_q M^-1 C_q^T, whose
// blocks are never formed.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/math/sparse_factor.h>

namespace pliant {

template <class S>
struct PartWorkspace;
template <class S>
struct ConstraintWorkspace;

class AugmentedFactor {
 public:
  AugmentedFactor(const Model& model, const Island& island);

  /// Factors the matrix for the joints that act, or for the closed ones only. C_q and M^-1 C_q^T must be in
  /// work.
  void factor(const std::vector<PartWorkspace<double>>& parts, const ConstraintWorkspace<double>& work,
              bool closed_only);
  /// x = W_c^-1 x; NaN if the factorisation failed.
  void solve(VecX<double>& x) const;

 private:
  const Model* model_;
  const Island* island_;
  std::vector<std::vector<std::pair<int, int>>> sides_of_;  ///< of each part: joint, its side
  SparseMatrix K_;
  std::unique_ptr<SparseFactor> factor_;
  bool sound_ = false;
};

/// Largest number of rows of an island for dependent_rows().
inline constexpr int kMaxRankRows = 900;
/// Returns which rows of C_q of an island depend on others, by a sparse QR factorisation. It serves messages,
/// not steps. In islands of more than kMaxRankRows rows, no row is reported.
std::vector<bool> dependent_rows(const Model& model, const Island& island,
                                 const ConstraintWorkspace<double>& work);

}  // namespace pliant
