// The steps of a run: fixed or with a tolerance, to the end of a schedule.
#pragma once

#include <pliant/io/frame_schedule.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

/// Returns whether a simulation has reached the end of a schedule.
inline bool at_end(const Simulation& simulation, const FrameSchedule& schedule) {
  return schedule.step() > 0 ? simulation.state().step >= schedule.steps()
                             : simulation.time() >= schedule.end();
}

/// Performs one step: of the length of the schedule, or of the length that the tolerance of the simulation
/// allows. Returns whether the new state is to be recorded.
inline bool scheduled_step(Simulation& simulation, const FrameSchedule& schedule) {
  if (schedule.step() > 0) {
    simulation.step(schedule.step());
    return schedule.records(simulation.state().step);
  }
  const double before = simulation.time();
  simulation.step_up_to(schedule.end());
  return schedule.records(before, simulation.time(), simulation.state().h);
}

}  // namespace pliant
