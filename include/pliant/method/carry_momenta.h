// The exact rotation of angular momenta by the gyroscopic term, for semi-implicit Euler.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Corrects the angular velocities after v <- v + h v_dot. The gyroscopic term -h omega x L rotates the
/// angular momentum L of each part about its centre of mass to first order in h. This function replaces that
/// term by the exact rotation by -h omega, in the frame of the part. |L| then stays constant if no torque
/// acts, and omega stays bounded for every h. Linear momenta and rates of parameters do not change. Parts
/// that deform locally and parts with a velocity without inertia are not corrected. v_before: velocities
/// before the update. h: length of the step, s. work: the evaluation that gave v_dot.
void carry_momenta(const Model& model, const Workspace<double>& work, const VecX<double>& v_before, double h,
                   State& state);

}  // namespace pliant
