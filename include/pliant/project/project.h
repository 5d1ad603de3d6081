// What happens between steps: limits stop parameters, strings go taut, open joints become closed when their
// gap has gone, and closed joints are projected back onto C = 0 and C_dot = 0 in the mass metric, which keeps
// the order of the method (design 1.5).
#pragma once

#include <pliant/body/dynamics.h>
#include <pliant/body/step_counters.h>

namespace pliant {

/// Gap, in lengths of the joint's smaller part, up to which a projection closes an open joint; its rate must
/// be at most kClosedRate lengths times the rate of the stabilization.
inline constexpr double kClosedGap = 1e-3, kClosedRate = 3e-3;

/// Where joints begin to act in an island: those with a small enough gap are closed, and the velocities are
/// made to agree with them by impulses. work: of an evaluation at the state; afterwards of its joints there;
/// scratch: any, kept from island to island. impulses: those on the rows of all joints are added, N s.
void engage_joints(const Dynamics& dynamics, double t, const Island& island, State& state,
                   Workspace<double>& work, Workspace<double>& scratch, StepCounters& counters,
                   VecX<double>& impulses);

/// Where the rates at which ends of joints are moved have jumped: impulses give an island the velocities that
/// agree with those of now, and their work is that of the hands (Work::anchors). work, impulses: as in
/// take_hold.
void follow_paths(const Dynamics& dynamics, double t, const Island& island, State& state,
                  Workspace<double>& work, StepCounters& counters, VecX<double>& impulses);

/// Before the coordinates move by h v: impulses that keep every parameter within its limits, every string
/// within its length and every closed joint closed at the end of the step. work: of the evaluation at the
/// start; before: the velocities then; q_end, ahead: any, kept from step to step.
void pre_step_impulses(const Dynamics& dynamics, Workspace<double>& work, const VecX<double>& before,
                       State& state, double h, VecX<double>& q_end, Workspace<double>& ahead,
                       StepCounters& counters);

/// After the coordinates moved: parameters that came to a limit are on it to the last bit.
void clamp_to_limits(const Model& model, State& state);

/// What ends the motion of a step, at time t (s): velocities that had no inertia rest, quaternions are of
/// unit length, and reference conditions are met, as project_frames says.
void end_motion(const Dynamics& dynamics, double t, State& state, Workspace<double>& work);

/// Parts that deform locally meet their reference conditions again, at time t (s); no node moves by it.
/// Throws NumericalFailure where the conditions no longer tell the coordinates apart.
void project_frames(const Dynamics& dynamics, double t, State& state, Workspace<double>& work);
/// The same of some parts.
void project_frames(const Dynamics& dynamics, double t, const std::vector<int>& parts, State& state,
                    Workspace<double>& work);

/// After a step, which ends at time t (s): parameters of parts without joints that passed a limit are
/// projected back in the mass metric, and stopped by impulses.
void project_limits(const Dynamics& dynamics, double t, State& state, Workspace<double>& work,
                    StepCounters& counters);

/// The same for parts with joints: open joints close that may, closed ones are projected, and limits and
/// strings with them.
void project_joints(const Dynamics& dynamics, double t, State& state, Workspace<double>& work,
                    StepCounters& counters);

}  // namespace pliant
