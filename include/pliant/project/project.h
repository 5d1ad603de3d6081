// Projection after a step: limits stop parameters, strings go taut, open joints become closed when their gap
// is small, and closed joints are projected onto C = 0 and C_dot = 0 in the mass metric, which keeps the
// order of the method (README.md of this folder).
#pragma once

#include <vector>

#include <pliant/body/step_context.h>

namespace pliant {

/// Largest gap, in lengths of the joint's smaller part, up to which a projection closes an open joint. The
/// rate of the gap must be at most kClosedRate lengths times the rate of the stabilization.
inline constexpr double kClosedGap = 1e-3, kClosedRate = 3e-3;

/// Engages the joints of an island that begin to act: joints with a small gap are closed, and impulses make
/// the velocities agree with them. On return step.work holds an evaluation of the joints of the island.
/// scratch: storage kept from island to island; its contents are ignored.
/// impulses: the impulses on the rows of all joints are added to it, N s.
void engage_joints(StepContext& step, const Island& island, Workspace<double>& scratch,
                   VecX<double>& impulses);

/// Applies the impulses that make the velocities of an island agree with the new rates of prescribed paths,
/// where these rates jump. The work goes to Work::anchors. impulses: as for engage_joints.
void follow_paths(StepContext& step, const Island& island, VecX<double>& impulses);

/// Storage of pre_step_impulses, kept from step to step; its contents are ignored.
struct PreStepStorage {
  VecX<double> q_end;       ///< coordinates at the end of the step
  Workspace<double> ahead;  ///< joints evaluated there
};
/// Applies impulses before the coordinates move by h v: at the end of the step every parameter is within its
/// limits, every string within its length and every closed joint closed. step.work: the evaluation at the
/// start of the step. v_start: the velocities there.
void pre_step_impulses(StepContext& step, const VecX<double>& v_start, PreStepStorage& storage);

/// Sets parameters that reached a limit to the limit, to the last bit.
void clamp_to_limits(const Model& model, State& state);

/// Ends the motion of a step at step.t: velocities without inertia are set to zero, quaternions are
/// normalised, and frames are projected (project_frames).
void end_motion(StepContext& step);

/// Projects the frames of parts that deform locally onto their reference conditions W^T d = 0 at step.t. No
/// node moves in the world. Throws NumericalFailure if the conditions no longer determine the frame.
void project_frames(StepContext& step);
/// Projects the frames of the parts with these numbers.
void project_frames(StepContext& step, const std::vector<int>& parts);

/// Projects parameters that passed a limit in the step that ends at step.t back in the mass metric and stops
/// them by impulses, for parts without joints.
void project_limits(StepContext& step);

/// Projects all islands at step.t: open joints with a small gap close, closed joints are projected, and
/// limits and strings of their parts with them. Throws UnsatisfiableModel if joints contradict each other.
void project_joints(StepContext& step);

}  // namespace pliant
