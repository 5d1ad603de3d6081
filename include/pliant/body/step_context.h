// The data of one step. All stages of the step receive them as one argument.
#pragma once

#include <pliant/body/dynamics.h>
#include <pliant/body/step_counters.h>

namespace pliant {

/// The data that every stage of a step reads and writes. The references must outlive the step.
struct StepContext {
  const Dynamics& dynamics;
  State& state;             ///< coordinates, velocities and discrete modes; the stages advance it
  Workspace<double>& work;  ///< results of the last evaluation
  StepCounters& counters;
  double t;  ///< time of the coordinates in the state, s: the start of the step, then its end
  double h;  ///< length of the step, s; 0 outside a step

  /// Makes the context of a step that begins at the time of the state and has the step length of the state.
  StepContext(const Dynamics& of, State& from, Workspace<double>& scratch, StepCounters& counts)
      : StepContext(of, from, scratch, counts, from.time(), from.h) {}
  StepContext(const Dynamics& of, State& from, Workspace<double>& scratch, StepCounters& counts, double time,
              double length)
      : dynamics(of), state(from), work(scratch), counters(counts), t(time), h(length) {}

  const Model& model() const { return dynamics.model(); }
  const JointPolicy& joint_policy() const { return dynamics.joint_policy(); }
};

}  // namespace pliant
