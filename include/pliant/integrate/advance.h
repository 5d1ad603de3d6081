// Moving a state along velocities: positions add, rotations turn by the exponential map.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// q <- q (+) h v: c and q_s add, theta <- theta o exp(h omega / 2).
void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h);

/// The same of one part.
void advance_part(const PartModel& m, VecX<double>& q, const VecX<double>& v, double h);

/// Writes the velocities v_r = (R^T c_dot, omega, q_s_dot) of a part into v.
void take_velocity(const PartModel& m, const PartWorkspace<double>& w, const VecMax<double>& v_r,
                   VecX<double>& v);

/// Brings every quaternion back to unit length.
void normalise_rotations(const Model& model, VecX<double>& q);

/// Zero rates for parameters that had no inertia at the last evaluation.
void hold_inertialess(const Model& model, const Workspace<double>& work, VecX<double>& v);

}  // namespace pliant
