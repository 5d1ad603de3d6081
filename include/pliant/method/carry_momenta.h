// Angular momenta that stay in the world while parts turn.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// After velocities of v_before have become those of a state by its accelerations times h (s): what makes of
/// -h omega x L, the first term, the whole turn of the angular momentum L of each part about its centre of
/// mass as the part turns by h omega. |L| then stays where nothing turns the part, and with it omega within
/// bounds, whatever h; P stays, and so do the rates of parameters. Parts that deform locally are left out.
/// work: of the accelerations.
void carry_momenta(const Model& model, const Workspace<double>& work, const VecX<double>& v_before, double h,
                   State& state);

}  // namespace pliant
