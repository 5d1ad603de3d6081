// Moving a state along velocities: positions add, rotations turn by the exponential map, and limits stop
// parameters.
#pragma once

#include <pliant/body/dynamics.h>
#include <pliant/integrate/integrator.h>

namespace pliant {

/// q <- q (+) h v: c and q_s add, theta <- theta o exp(h omega / 2).
void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h);

/// Brings every quaternion back to unit length.
void normalise_rotations(const Model& model, VecX<double>& q);

/// Zero rates for parameters that had no inertia at the last evaluation.
void hold_inertialess(const Model& model, const Workspace<double>& work, VecX<double>& v);

/// Before the coordinates move by h v: impulses that keep every parameter within its limits at the end of the
/// step.
void stop_at_limits_ahead(const Model& model, const Workspace<double>& work, State& state, double h,
                          StepCounters& counters);

/// After the coordinates moved: parameters that came to a limit are on it to the last bit.
void settle_on_limits(const Model& model, State& state);

/// After a step of a high-order method, which ends at time t (s): coordinates beyond a limit are projected
/// onto it in the mass metric, and outward velocities are stopped by impulses.
void stop_at_limits(const Dynamics& dynamics, double t, State& state, Workspace<double>& work,
                    StepCounters& counters);

}  // namespace pliant
