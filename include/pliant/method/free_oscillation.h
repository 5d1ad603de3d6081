// Exact integration of local coordinates that are free oscillators, q_ddot = -omega^2 q - D q_dot + n. The
// first two terms are solved exactly, and n as a constant over the step. Joints and other rows make
// oscillators stiff together with what they tie, so that the method integrates these.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

/// Returns whether the local coordinates of a part are free oscillators.
bool oscillates_freely(const PartModel& part);

/// Coefficients of the motion over a time, one entry for each oscillator; n: the constant load:
///   q <- qq q + qv q_dot + qn n,   q_dot <- vq q + vv q_dot + qv n
struct OscillatorMoves {
  VecX<double> qq, qv, vq, vv, qn;
};
OscillatorMoves moves_over(const Oscillators& oscillators, double t);
/// The coefficients qv and vv alone: the effect of a change of q_dot after a time.
struct OscillatorKicks {
  VecX<double> qv, vv;
};
OscillatorKicks kicks_over(const Oscillators& oscillators, double t);

}  // namespace pliant
