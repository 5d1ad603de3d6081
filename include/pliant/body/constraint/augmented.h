// The augmented matrix of Eq. (14) for the joints of an island,
//   [ M    C_q^T ]
//   [ C_q   -d I ]
// sparse and quasi-definite: a small d keeps rows that depend on others harmless, and iterative refinement
// takes its error out again for all others. It answers what W_c = C_q M^-1 C_q^T would, whose blocks it never
// forms.
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

  /// Factors it for the joints that act, or the closed ones alone; C_q and M^-1 C_q^T are in work.
  void factor(const std::vector<PartWorkspace<double>>& parts, const ConstraintWorkspace<double>& work,
              bool closed_only);
  /// x = W_c^-1 x.
  void solve(VecX<double>& x) const;

 private:
  const Model* model_;
  const Island* island_;
  std::vector<std::vector<std::pair<int, int>>> sides_of_;  ///< of each part: joint, side
  SparseMatrix K_;
  std::unique_ptr<SparseFactor> factor_;
  bool sound_ = false;
};

/// Which rows of C_q of an island depend on others, by a sparse QR factorisation: for people, not for steps.
/// In islands of more than kMostForRank rows none is looked for.
inline constexpr int kMostForRank = 900;
std::vector<bool> dependent_rows(const Model& model, const Island& island,
                                 const ConstraintWorkspace<double>& work);

}  // namespace pliant
