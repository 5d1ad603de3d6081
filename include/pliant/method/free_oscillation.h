// Exact integration of local coordinates that are free oscillators, q_ddot = -omega^2 q - D q_dot + n with a
// constant load n. Joints and other rows couple oscillators to stiff motion: the method integrates those.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

/// Returns whether the local coordinates of a part are free oscillators: it has modes and no joints.
bool oscillates_freely(const PartModel& part);

/// The exact motion of free oscillators over a time t, one entry for each oscillator:
///   q <- qq q + qv q_dot + qn n,   q_dot <- vq q + vv q_dot + qv n
struct OscillatorPropagator {
  VecX<double> qq, qv, vq, vv, qn;
};
/// Returns the propagator over t (s).
OscillatorPropagator propagator(const Oscillators& oscillators, double t);
/// The entries qv and vv alone: the effect of a change of q_dot after a time t.
struct VelocityResponse {
  VecX<double> qv, vv;
};
/// Returns the response to a change of q_dot after t (s).
VelocityResponse velocity_response(const Oscillators& oscillators, double t);

}  // namespace pliant
