// Projection after a step. Limits stop parameters, strings become taut, and open joints with a small gap
// become closed. Closed joints are projected onto C = 0 and C_dot = 0, Eq. (12), in the mass metric, which
// preserves the order of the method (README.md of this folder).
#pragma once

#include <vector>

#include <pliant/body/step_context.h>

namespace pliant {

/// An open joint becomes closed if its gap is at most kClosedGap times the size of its smaller part, and the
/// rate of the gap is at most kClosedRate times this size times Stabilization::rate. For methods of first
/// order both limits are larger while the joint rotates (close_joints() in project_joints-inl.h).
inline constexpr double kClosedGap = 1e-3, kClosedRate = 3e-3;

/// Engages the joints of an island that begin to act. If closed joints are projected, joints with a small gap
/// become closed, at any rate of the gap. A closing string becomes slack if the distance of its ends is below
/// its length, and closed if the string is slightly too long.
/// Impulses make the velocities agree with the closed joints. The function adds these impulses (N s), on the
/// rows of all joints, to `impulses`. On return step.work is an evaluation of the joints of the island.
/// scratch: scratch storage; its contents are ignored. The change of energy is added to Work::projection. It
/// is added to Work::limits instead if the projection moved a parameter back to a limit, or pulled a string,
/// and this limit or string did not push in the last evaluation.
void engage_joints(StepContext& step, const Island& island, Workspace<double>& scratch,
                   VecX<double>& impulses);

/// Applies the impulses that make the velocities of an island agree with the new rates of prescribed paths at
/// a kink, where these rates jump. The work is added to Work::anchors. impulses: as for engage_joints().
void follow_paths(StepContext& step, const Island& island, VecX<double>& impulses);

/// Scratch storage of pre_step_impulses(); its contents are ignored.
struct PreStepStorage {
  VecX<double> q_end;       ///< coordinates at the end of the step
  Workspace<double> ahead;  ///< evaluation of the joints at q_end
};
/// Applies impulses before the coordinates move by h v. With these impulses, at the end of the step every
/// parameter is within its limits, no slack or closed string is longer than its length, and closed joints
/// have no gap if they are projected. Sleeping islands are skipped. step.work: the evaluation at the start of
/// the step. v_start: the velocities at the start of the step.
void pre_step_impulses(StepContext& step, const VecX<double>& v_start, PreStepStorage& storage);

/// Sets each parameter that is at a limit according to State::at_limit exactly to the value of this limit.
void clamp_to_limits(const Model& model, State& state);

/// Ends the motion of a step at step.t: velocities without inertia are set to zero, quaternions are
/// normalised, and frames are projected (project_frames).
void end_motion(StepContext& step);

/// Projects the frames of parts that deform locally onto their reference conditions W^T d = 0 at step.t. No
/// node moves in the world. Throws NumericalFailure if the conditions no longer determine the frame.
void project_frames(StepContext& step);
/// Projects the frames of some parts. parts: numbers of these parts.
void project_frames(StepContext& step, const std::vector<int>& parts);

/// For parts without joints: projects parameters that have passed a limit in the step that ends at step.t
/// onto this limit, in the mass metric, and stops these parameters by impulses. Does nothing if the state is
/// not finite.
void project_limits(StepContext& step);

/// Projects all islands at step.t, with the limits and strings of their parts: open joints with a small gap
/// become closed, and closed joints are projected. Skips sleeping islands. Throws UnsatisfiableModel if
/// joints contradict each other, and NumericalFailure if the step is too long. Does nothing if the state is
/// not finite.
void project_joints(StepContext& step);

/// Throws UnsatisfiableModel if a joint is open, and other joints contradict the equation that closes it.
/// step.work: an evaluation of the accelerations at the state. Rigid islands are skipped.
void fail_on_open_conflict(StepContext& step);

}  // namespace pliant
