// The augmented matrix of Eq. (14) for the joints of an island,
//   [ M    C_q^T ]
//   [ C_q   -d   ]      d: diagonal, small and positive
// The matrix is sparse. The entries of d make the matrix quasi-definite, so that it can be factored even if
// rows of C_q depend on each other. Iterative refinement removes the error that d causes in all independent
// rows. The factor solves systems with W_c = C_q M^-1 C_q^T without forming W_c.
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

  /// Factors the matrix for the joints in mode closing or closed (JointMode, body/state.h). closed_only: for
  /// the closed joints only. `work` must contain C_q and M^-1 C_q^T of these joints.
  void factor(const std::vector<PartWorkspace<double>>& parts, const ConstraintWorkspace<double>& work,
              bool closed_only);
  /// Replaces x by W_c^-1 x, or by NaN if the factorisation failed.
  void solve(VecX<double>& x) const;

 private:
  const Model* model_;
  const Island* island_;
  std::vector<std::vector<std::pair<int, int>>> sides_of_;  ///< of each part: (joint, its side)
  SparseMatrix K_;
  std::unique_ptr<SparseFactor> factor_;
  bool factored_ = false;
};

/// Largest number of rows of an island for dependent_rows().
inline constexpr int kMaxRankRows = 900;
/// Returns for each row of C_q of an island whether the row depends linearly on other rows, by a sparse QR
/// factorisation. The result is for messages; a step does not call this function. For an island of more than
/// kMaxRankRows rows, all entries are false.
std::vector<bool> dependent_rows(const Model& model, const Island& island,
                                 const ConstraintWorkspace<double>& work);

}  // namespace pliant
