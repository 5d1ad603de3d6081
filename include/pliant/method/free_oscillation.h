// Exact integration of local coordinates that are free oscillators: q_ddot = -omega^2 q - D q_dot + n with a
// constant load n, the acceleration by all other forces. The modes of a part with joints or strings are not
// free: rows of joints and strings couple these modes to other motion, which may be stiff. The method of
// integration advances them like other coordinates.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

/// Returns whether the local coordinates of a part are free oscillators: the part has modes and no joints or
/// strings.
bool oscillates_freely(const PartModel& part);

/// The exact motion of free oscillators over a time t, one entry for each oscillator:
///   q <- qq q + qv q_dot + qn n,   q_dot <- vq q + vv q_dot + qv n
struct OscillatorPropagator {
  VecX<double> qq, qv, vq, vv, qn;
};
/// Returns the propagator over t (s).
OscillatorPropagator propagator(const Oscillators& oscillators, double t);
/// The entries qv and vv alone: q and q_dot at time t, for q = 0 and q_dot = 1 at time 0.
struct VelocityResponse {
  VecX<double> qv, vv;
};
/// Returns the response at t (s) to a unit change of q_dot at time 0, one entry for each oscillator.
VelocityResponse velocity_response(const Oscillators& oscillators, double t);

}  // namespace pliant
