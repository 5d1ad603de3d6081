// Counters of what the steps of a simulation did.
#pragma once

namespace pliant {

/// Counts what a method did.
struct StepCounters {
  long steps = 0;
  long evaluations = 0;   ///< of the accelerations
  long rejected = 0;      ///< steps whose error was too large, taken again
  long uncontrolled = 0;  ///< steps to a tolerance in which many bodies, or soft ones, lay there
  long limit_impulses = 0;
  long factorisations = 0;      ///< of the stiffness of nodes
  long impacts = 0;             ///< whose time in the step was found
  long contact_sweeps = 0;      ///< over all contacts
  long contact_fallbacks = 0;   ///< see CoulombResult
  long contact_cutoffs = 0;     ///< rounds of what pushes push, or impacts in a step, that were not taken
  double contact_residual = 0;  ///< the worst of them, m/s
};

}  // namespace pliant
