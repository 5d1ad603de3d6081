// The joints of all parts at an evaluation, Eqs. (12)-(14): their rows, and the forces lambda from
//   W_c lambda = -(C_q a + bias + 2 alpha C_dot + beta^2 C),   W_c = C_q M^-1 C_q^T,
// a being the accelerations without joints. What is found is added to them: a + M^-1 C_q^T lambda.
#pragma once

#include <vector>

#include <pliant/body/model.h>
#include <pliant/body/stabilization.h>
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
};

/// What is recomputed at each evaluation. The rows of all joints stand in the order of the joints.
template <class S>
struct ConstraintWorkspace {
  std::vector<JointMode> modes;     ///< as they were at the evaluation
  Gains gains;                      ///< of Baumgarte's terms of joints that close
  bool stabilise_closed = true;     ///< whether closed joints have them too
  double most_speed = 0;            ///< cap of the speed at which a gap closes, body lengths / s
  VecX<S> C, C_dot, bias;           ///< m, m/s, m/s^2
  VecX<S> Cq, Y;                    ///< C_q^T and M^-1 C_q^T of each side, n_v x rows, on v_r
  VecX<S> lambda;                   ///< N; on the parts act C_q^T lambda
  std::vector<BlockFactor<S>> W_c;  ///< of each island, of the joints that act
  /// The same of the closed joints alone, where there are others that close: impulses keep the closed ones
  /// and may open the others.
  std::vector<BlockFactor<S>> W_closed;
  std::vector<std::vector<OneSidedRow>> pushed;  ///< of each island
};

/// Rows of the joints: C, C_dot, bias, C_q.
template <class S>
void evaluate_joints(const Model& model, const Island& island, double t,
                     const std::vector<PartWorkspace<S>>& parts, ConstraintWorkspace<S>& work);

/// M^-1 C_q^T and the factors of W_c; rows of joints that do not act are held.
template <class S>
void factor_joints(const Model& model, const Island& island, const std::vector<PartWorkspace<S>>& parts,
                   ConstraintWorkspace<S>& work);

/// Below this smallest pivot of W_c its solutions are refined.
inline constexpr double kRefineBelow = 1e-5;

/// Finds lambda and adds M^-1 C_q^T lambda to the accelerations of the parts. One-sided rows that could push
/// are those of the strings that act and of `limits`; which of them do is told in work.joints.pushed.
void solve_joints(const Model& model, const Island& island, std::vector<OneSidedRow> limits,
                  Workspace<double>& work);
/// The same for a derivative, with the rows of work.joints.pushed pushing.
void solve_joints(const Model& model, const Island& island, Workspace<Dual<1>>& work);

/// Rates of the works of the joints, W.
template <class S>
Vec<S, kWorks> joint_power(const Model& model, const Workspace<S>& work);

/// Rows of a joint that follow from those of others, which hold them; after an evaluation.
int redundant_rows(const Model& model, const ConstraintWorkspace<double>& work, int joint);

/// Whether a joint acts in this mode.
inline bool acts(JointMode mode) {
  return mode == JointMode::closing || mode == JointMode::closed;
}

}  // namespace pliant
