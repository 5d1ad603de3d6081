// Local coordinates that are oscillators, q_ddot = -omega^2 q - D q_dot + what else acts: where no joints
// hold them, the first two terms are solved exactly, and with them a constant of the rest. Held by joints
// they are left to the method: what holds them is as stiff as they are.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

/// Whether the local coordinates of a part are moved so.
bool oscillates_freely(const PartModel& part);

/// The motion of oscillators over a time, an entry an oscillator: with n what else acts, constant,
///   q <- qq q + qv q_dot + qn n,   q_dot <- vq q + vv q_dot + qv n
struct OscillatorMoves {
  VecX<double> qq, qv, vq, vv, qn;
};
OscillatorMoves moves_over(const Oscillators& oscillators, double t);
/// What changes of q_dot become over a time: qv and vv of these.
struct OscillatorKicks {
  VecX<double> qv, vv;
};
OscillatorKicks kicks_over(const Oscillators& oscillators, double t);

}  // namespace pliant
