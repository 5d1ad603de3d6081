// The joints at an evaluation, Eqs. (12)-(14): their rows C, C_dot, bias and C_q, and the forces lambda from
//   W_c lambda = -(C_q a + bias + 2 alpha C_dot + beta^2 C),   W_c = C_q M^-1 C_q^T,
// where a are the accelerations without joints, and bias = -gamma of Eq. (13). The accelerations with joints
// are a + M^-1 C_q^T lambda. The sign of lambda is opposite to the paper's: the force on the parts is +C_q^T
// lambda. A joint "acts" (exerts forces) if its JointMode is closing or closed. Here a "string" is any
// one-sided joint (Island::strings), also a limit of the coordinate of a joint.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <pliant/body/constraint/augmented.h>
#include <pliant/body/constraint/stabilization.h>
#include <pliant/body/model.h>
#include <pliant/solve/block_factor.h>

namespace pliant {

template <class S>
struct PartWorkspace;
template <class S>
struct Workspace;

/// A one-sided row of a group of parts (group.h): sign * x_i >= bound, where x_i is velocity 6 + k of a part,
/// or sign * C_q x >= bound for a string. x: the velocities or accelerations of the group.
struct OneSidedRow {
  int part;  ///< number of the part in the group; -1: the row of a string
  int k;     ///< number of a dynamic parameter of the part, or of a string of the island
  /// 1 at a lower limit and -1 at an upper limit. 1 for a string; projection also uses -1, to keep a taut
  /// string from becoming slack.
  double sign;
  double bound;
  /// Compliance of the row: the row may miss its bound by this fraction of the change that its own push
  /// causes. With softness, rows that contradict each other have a solution.
  double softness = 0;
};

/// The factor of W_c of an island: by the blocks of W_c, or by the augmented matrix.
template <class S>
class JointFactor {
 public:
  /// Factors W_c for the joints that act; closed_only: for the closed joints only. Calls prepare(j) for each
  /// joint j in turn. prepare(j) computes C_q and M^-1 C_q^T of the joint in `work`, unless `work` contains
  /// them already.
  template <class F>
  void factor(const Model& model, const Island& island, const std::vector<PartWorkspace<S>>& parts,
              const ConstraintWorkspace<S>& work, bool closed_only, F&& prepare);
  /// The blocks of W_c, for a caller that fills them in and factors them itself.
  BlockFactor<S>& blocks() { return blocks_; }
  /// For a derivative: keeps a reference to the augmented factor, if there is one, of the evaluation whose
  /// derivative is computed. values: the JointFactor of that evaluation.
  void refer_to(const JointFactor<double>& values) { values_ = values.augmented_.get(); }

  /// Replaces x by W_c^-1 x, with zeros for dependent rows. A derivative with the augmented matrix treats W_c
  /// as constant. In this case exact() is false, and the result is exact only after a second solution for the
  /// residual.
  void solve(VecX<S>& x) const;
  bool exact() const { return values_ == nullptr; }
  /// Returns for each row whether the row depends linearly on other rows.
  std::vector<bool> dependent(const Model& model, const Island& island,
                              const ConstraintWorkspace<S>& work) const;
  /// Returns whether solutions need iterative refinement.
  bool is_rough() const;

 private:
  /// Adds the coupling of two joints through a part to its block.
  void couple(const Model& model, const Coupling& coupling, const ConstraintWorkspace<S>& work);

  friend class JointFactor<Dual<1>>;
  BlockFactor<S> blocks_;
  std::unique_ptr<AugmentedFactor> augmented_;
  const AugmentedFactor* values_ = nullptr;
};

/// Vectors of a group, see group.h. The vectors of islands stay in the workspace, so that a step allocates no
/// memory.
template <class S, int Max>
struct GroupVectors {
  VecMax<S, Max> before, joined,
      x;  ///< accelerations or velocities: without forces of joints, with these forces, and with these forces
          ///< and the pushes of one-sided rows
  VecX<S> rows, lambda;        ///< rows C_q x of the joints, and their forces
  VecX<S> correction, change;  ///< lambda and change of x of the last Group::correct()
  VecMax<S, Max> start, gain;  ///< velocities at the evaluation of the joints, and their change since then
  VecX<S> gained;              ///< C_q gain, the change of C_dot of the joints
  VecX<S> q, v;                ///< stored coordinates and velocities (Snapshot, project/project_joints-inl.h)
};

/// The quantities of all joints at an evaluation. Rows of all joints are in the order of the joints. The
/// fields are in the order of their computation.
template <class S>
struct ConstraintWorkspace {
  std::vector<JointMode> modes;  ///< mode of each joint at this evaluation
  Gains gains;                   ///< alpha and beta of Baumgarte's terms
  bool stabilise_closed = true;  ///< whether closed joints have Baumgarte's terms; closing joints always do
  RankRule rank = RankRule::decide;  ///< rule by which the factors of W_c find dependent rows
  double max_speed = 0;              ///< largest speed at which a gap closes / JointModel::length, 1/s
  VecX<S> C, C_dot, bias;            ///< in m, m/s and m/s^2, n_rows each; bias = -gamma
  VecX<S> Cq, Y;                     ///< C_q^T and Y = M^-1 C_q^T of each side, n_x x rows (group.h)
  std::vector<JointFactor<S>> W_c;   ///< for each island: the factor of the joints that act
  /// For each island with closing joints: the factor of the closed joints only. Impulses keep the closed
  /// joints closed and may open the closing joints.
  std::vector<JointFactor<S>> W_closed;
  VecX<S> lambda;                                ///< N, n_rows; the force on the parts is C_q^T lambda
  std::vector<std::vector<OneSidedRow>> pushed;  ///< of each island: the one-sided rows with a push > 0
  std::vector<GroupVectors<S, Eigen::Dynamic>> vectors;  ///< of each island
};

/// A function that evaluates the part with a given number, as far as the joints on the part need it.
using EvaluatePart = std::function<void(int)>;

/// Computes C, C_dot, bias and C_q of the joints of an island at time t (s). Calls evaluate(i), if given, for
/// the parts of the island in turn: each part is evaluated before the first joint on this part. Part and
/// joint are then in the cache together.
template <class S>
void evaluate_joints(const Model& model, const Island& island, double t,
                     const std::vector<PartWorkspace<S>>& parts, ConstraintWorkspace<S>& work,
                     const EvaluatePart& evaluate = {});

/// Computes M^-1 C_q^T and the factors of W_c of an island. Rows of joints that do not act are left out.
template <class S>
void factor_joints(const Model& model, const Island& island, const std::vector<PartWorkspace<S>>& parts,
                   ConstraintWorkspace<S>& work);

/// Does evaluate_joints() and factor_joints() joint by joint.
template <class S>
void evaluate_and_factor_joints(const Model& model, const Island& island, double t,
                                const std::vector<PartWorkspace<S>>& parts, ConstraintWorkspace<S>& work,
                                const EvaluatePart& evaluate = {});

/// Returns the diagonal entry of W_c of row `row` of joint j. For a joint between two points of one part,
/// returns the sum of the entries that each side alone would have. If the motion of the part cannot move one
/// point relative to the other, the sides cancel in W_c: the true entry is then only a rounding error of this
/// sum.
template <class S>
double diagonal_of_ends(const Model& model, const ConstraintWorkspace<S>& work, int j, int row);

/// Solves for lambda and adds M^-1 C_q^T lambda to the accelerations a_r of the parts, Eq. (14). The
/// candidates for one-sided pushes are the strings that act and the rows `limits`. Stores the candidates
/// that push in work.joints.pushed.
void solve_joints(const Model& model, const Island& island, std::vector<OneSidedRow> limits,
                  Workspace<double>& work);
/// Solves for the derivatives of lambda and of the accelerations, with pushes on the rows of
/// work.joints.pushed.
void solve_joints(const Model& model, const Island& island, Workspace<Dual<1>>& work);

/// Returns bias + 2 alpha C_dot + beta^2 C of joint j, which is -(gamma - 2 alpha C_dot - beta^2 C) in the
/// terms of the paper. The accelerations a have to satisfy C_q a = -wanted.
template <class S>
VecMax<S, kMaxJointRows> wanted(const Model& model, const ConstraintWorkspace<S>& joints, int j);
/// Returns |C_q a + wanted| of joint j for the accelerations a of an evaluation, m/s^2; for a one-sided joint
/// max(0, -(C_q a + wanted)). The result is zero within rounding except in two cases: rows of the joint
/// contradict other rows, or the forces of closing joints are limited (kMaxClosingRatio, solve_joints-inl.h).
double disagreement(const Model& model, const Workspace<double>& work, int j);

/// Returns the power of the joints for each kind of work (enum Work), W.
template <class S>
Vec<S, kWorks> joint_power(const Model& model, const Workspace<S>& work);

/// Returns for each joint the number of its rows that depend linearly on other rows, after an evaluation.
std::vector<int> redundant_rows(const Model& model, const ConstraintWorkspace<double>& work);

/// Returns whether a joint with this mode acts (exerts forces).
inline bool acts(JointMode mode) {
  return mode == JointMode::closing || mode == JointMode::closed;
}
/// Returns whether a factor contains a joint with this mode: only closed joints if closed_only, else all
/// joints that act.
inline bool is_selected(JointMode mode, bool closed_only) {
  return closed_only ? mode == JointMode::closed : acts(mode);
}

}  // namespace pliant
