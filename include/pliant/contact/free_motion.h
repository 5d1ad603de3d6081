// A motion: one step of the method of integration, without contact impulses at its end.
#pragma once

#include <pliant/body/state.h>

namespace pliant {

/// The velocities and works before predicted impulses act at the start of a motion (predicted_impulses.h).
struct BeforePrediction {
  VecX<double> v;                                          ///< n_v; empty if no predicted impulses act
  Vec<double, kWorks> work = Vec<double, kWorks>::Zero();  ///< State::work, J
};

struct FreeMotion {
  State before;                  ///< state at the start, after the predicted impulses
  BeforePrediction unpredicted;  ///< velocities and works before these impulses
  double begin = 0;              ///< time of the start, s
  double h = 0;                  ///< length, s
  double reach = 0;  ///< a constant acceleration a displaces by reach * a * h^2 (Integrator::reach)
  /// An impact rebounds only if its rebound is faster than this, m/s. Rounding and gravity within a fraction
  /// of a step cause slower impacts.
  double min_impact_speed = 0;
  /// Largest normal speed of a resting contact, m/s. It includes the residual of the last impulses
  /// (State::contact_residual).
  double max_resting_speed = 0;
  /// Largest normal speed of a resting contact that is smooth (ContactFinder::is_smooth) and has no
  /// restitution, m/s. Impacts at such a contact have no rebound and end at rest. If no impulses are
  /// predicted, this speed is equal to max_resting_speed.
  double max_inelastic_speed = 0;

  double end() const { return begin + h; }
  /// Returns Contact::since (s) of an impulse at the end of the motion that stands for a constant force
  /// during the motion. The impulse displaces bodies by this time multiplied by the change of velocity.
  double force_time() const { return reach * h; }
  bool has_predicted() const { return unpredicted.v.size() > 0; }
  /// Returns the state at the start before the predicted impulses.
  State restart() const {
    State start = before;
    if (!has_predicted()) return start;
    start.v = unpredicted.v;
    start.work = unpredicted.work;
    return start;
  }
};

}  // namespace pliant
