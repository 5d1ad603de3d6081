// The joints of all parts at an evaluation, Eqs. (12)-(14): their rows, and the forces lambda from
//   W_c lambda = -(C_q a + bias + 2 alpha C_dot + beta^2 C),   W_c = C_q M^-1 C_q^T,
// a being the accelerations without joints. What is found is added to them: a + M^-1 C_q^T lambda.
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

/// A one-sided row of parts that act on each other: sign * x >= bound for velocity 6 + k of a part, or a
/// string's C_q x >= bound.
struct OneSidedRow {
  int part;  ///< its number in the group; -1: k is the number of a string in the island
  int k;
  double sign;  ///< 1 at a lower limit and for a string, -1 at an upper limit
  double bound;
  double softness = 0;  ///< it is met but for this share of its own push: rows that contradict each other end
};

/// W_c of an island, factored by blocks or within the augmented matrix.
template <class S>
class JointFactor {
 public:
  /// Factors it for the joints that act, or the closed ones alone. prepare(j), called of each joint in turn,
  /// lays its C_q and M^-1 C_q^T in `work` where they are not there yet.
  template <class F>
  void factor(const Model& model, const Island& island, const std::vector<PartWorkspace<S>>& parts,
              const ConstraintWorkspace<S>& work, bool closed_only, F&& prepare);
  /// The blocks of W_c, to be filled in and factored by others.
  BlockFactor<S>& blocks() { return blocks_; }
  /// That of the values, for a derivative of the augmented matrix.
  void refer_to(const JointFactor<double>& values) { values_ = values.augmented_.get(); }

  /// x = W_c^-1 x, with zeros for rows that depend on others. A derivative by the augmented matrix takes W_c
  /// for constant, which is exact once what is left is solved again.
  void solve(VecX<S>& x) const;
  bool exact() const { return values_ == nullptr; }
  /// Which rows depend on others.
  std::vector<bool> dependent(const Model& model, const Island& island,
                              const ConstraintWorkspace<S>& work) const;
  /// Whether solutions are to be refined.
  bool is_rough() const;

 private:
  /// Adds what two joints do to each other, through a part, to its block.
  void couple(const Model& model, const Coupling& coupling, const ConstraintWorkspace<S>& work);

  friend class JointFactor<Dual<1>>;
  BlockFactor<S> blocks_;
  std::unique_ptr<AugmentedFactor> augmented_;
  const AugmentedFactor* values_ = nullptr;
};

/// Vectors of parts that act on each other at once, see group.h. Those of islands are kept, so that a step
/// takes nothing from the heap.
template <class S, int Max>
struct GroupVectors {
  VecMax<S, Max> before, joined, x;  ///< accelerations or velocities: without joints, with them, with all
  VecX<S> rows, lambda;              ///< of the joints
  VecX<S> correction, change;        ///< of lambda and of x, by Group::correct
  VecMax<S, Max> start, gain;        ///< velocities at which joints were evaluated, and what came to them,
  VecX<S> gained;                    ///< and to their rows
  VecX<S> q, v;                      ///< coordinates and velocities of a state
};

/// What is recomputed at each evaluation. The rows of all joints stand in the order of the joints.
template <class S>
struct ConstraintWorkspace {
  std::vector<JointMode> modes;      ///< as they were at the evaluation
  Gains gains;                       ///< of Baumgarte's terms of joints that close
  bool stabilise_closed = true;      ///< whether closed joints have them too
  RankRule rank = RankRule::decide;  ///< of the factors
  double most_speed = 0;             ///< cap of the speed at which a gap closes, body lengths / s
  VecX<S> C, C_dot, bias;            ///< m, m/s, m/s^2
  VecX<S> Cq, Y;                     ///< C_q^T and M^-1 C_q^T of each side, n_v x rows, on v_r
  VecX<S> lambda;                    ///< N; on the parts act C_q^T lambda
  std::vector<JointFactor<S>> W_c;   ///< of each island, of the joints that act
  /// The same of the closed joints alone, where there are others that close: impulses keep the closed ones
  /// and may open the others.
  std::vector<JointFactor<S>> W_closed;
  std::vector<std::vector<OneSidedRow>> pushed;          ///< of each island
  std::vector<GroupVectors<S, Eigen::Dynamic>> vectors;  ///< of each island
};

/// Brings a part of an island to where its joints can be evaluated.
using PlacePart = std::function<void(int)>;

/// Rows of the joints: C, C_dot, bias, C_q. place(i), if given, is called for each part of the island, before
/// the first of its joints is evaluated; so the caches hold it still.
template <class S>
void evaluate_joints(const Model& model, const Island& island, double t,
                     const std::vector<PartWorkspace<S>>& parts, ConstraintWorkspace<S>& work,
                     const PlacePart& place = {});

/// M^-1 C_q^T and the factors of W_c; rows of joints that do not act are held.
template <class S>
void factor_joints(const Model& model, const Island& island, const std::vector<PartWorkspace<S>>& parts,
                   ConstraintWorkspace<S>& work);

/// Both, a joint at a time.
template <class S>
void evaluate_and_factor_joints(const Model& model, const Island& island, double t,
                                const std::vector<PartWorkspace<S>>& parts, ConstraintWorkspace<S>& work,
                                const PlacePart& place = {});

/// The diagonal entry of W_c of a row of a joint. Of a joint between points of one part it is that of its two
/// sides each alone, which cancel where nothing changes between the points: what is left is to be measured
/// against them.
template <class S>
double entry_of_ends(const Model& model, const ConstraintWorkspace<S>& work, int j, int row);

/// Finds lambda and adds M^-1 C_q^T lambda to the accelerations of the parts. One-sided rows that could push
/// are those of the strings that act and of `limits`; which of them do is told in work.joints.pushed.
void solve_joints(const Model& model, const Island& island, std::vector<OneSidedRow> limits,
                  Workspace<double>& work);
/// The same for a derivative, with the rows of work.joints.pushed pushing.
void solve_joints(const Model& model, const Island& island, Workspace<Dual<1>>& work);

/// bias + 2 alpha C_dot + beta^2 C of a joint: what C_ddot is to be minus, but for what the accelerations
/// give.
template <class S>
VecMax<S, kMaxJointRows> wanted(const Model& model, const ConstraintWorkspace<S>& joints, int j);
/// How far an evaluation is from giving a joint that, m/s^2: not at all, unless its rows depend on others
/// that disagree.
double disagreement(const Model& model, const Workspace<double>& work, int j);

/// Rates of the works of the joints, W.
template <class S>
Vec<S, kWorks> joint_power(const Model& model, const Workspace<S>& work);

/// Of each joint, the number of its rows that follow from those of others, which hold them; after an
/// evaluation.
std::vector<int> redundant_rows(const Model& model, const ConstraintWorkspace<double>& work);

/// Whether a joint acts in this mode.
inline bool acts(JointMode mode) {
  return mode == JointMode::closing || mode == JointMode::closed;
}
/// The same, or whether it is closed.
inline bool counts(JointMode mode, bool closed_only) {
  return closed_only ? mode == JointMode::closed : acts(mode);
}

}  // namespace pliant
