// Counters of the work that the steps of a simulation did.
#pragma once

#include <algorithm>

namespace pliant {

struct StepCounters {
  long steps = 0;        ///< accepted steps
  long evaluations = 0;  ///< evaluations of the accelerations
  long rejected = 0;     ///< steps that were rejected for their error and repeated with a shorter length
  /// Accepted steps of a run to a tolerance whose contact error is not controlled: they have resting
  /// contacts, or impacts that were not located.
  long uncontrolled = 0;
  long limit_impulses = 0;  ///< impulses at limits of parameters and on strings
  long factorisations = 0;  ///< factorisations of the matrices of implicit methods
  long impacts = 0;         ///< impacts whose time within the step was located
  long contact_sweeps = 0;  ///< sweeps over all contacts of a cluster, summed over the clusters
  /// Clusters whose search was repeated with compliant contacts, see CoulombResult::fallbacks
  /// (solve/coulomb_system.h).
  long contact_fallbacks = 0;
  long contact_cutoffs =
      0;  ///< how often a step reached its limit of rounds of contact resolution or of located impacts
  double contact_residual = 0;  ///< largest residual of a contact solution, m/s

  /// Adds counts, and keeps the larger residual.
  StepCounters& operator+=(const StepCounters& other) {
    steps += other.steps;
    evaluations += other.evaluations;
    rejected += other.rejected;
    uncontrolled += other.uncontrolled;
    limit_impulses += other.limit_impulses;
    factorisations += other.factorisations;
    impacts += other.impacts;
    contact_sweeps += other.contact_sweeps;
    contact_fallbacks += other.contact_fallbacks;
    contact_cutoffs += other.contact_cutoffs;
    contact_residual = std::max(contact_residual, other.contact_residual);
    return *this;
  }
};

}  // namespace pliant
