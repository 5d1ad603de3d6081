// Counters of the steps of a simulation: computations, events, and the largest errors of contact.
#pragma once

#include <algorithm>

namespace pliant {

/// A violation of the laws of contact: a velocity, m/s, or an overlap, m.
struct ContactViolation {
  double value = 0;      ///< m/s or m
  double tolerance = 0;  ///< the allowed violation, m/s or m
  double time = 0;       ///< end of the step with this violation, s

  bool is_allowed() const { return value <= tolerance; }
  /// Replaces this violation by `other` if the ratio of value to tolerance is larger for `other`.
  void keep_worse(const ContactViolation& other) {
    if (other.value * tolerance > value * other.tolerance || (value == 0 && other.value > 0)) *this = other;
  }
};

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
  /// Sweeps over all contacts of a cluster, summed over the clusters. A cluster is a set of bodies that
  /// contacts connect.
  long contact_sweeps = 0;
  /// Clusters whose search for contact impulses was repeated with compliant contacts, see
  /// CoulombResult::fallbacks (solve/coulomb_system.h).
  long contact_fallbacks = 0;
  /// How often a step reached the largest number of rounds of contact resolution or separation, of located
  /// impacts, or of impacts in a sequence.
  long contact_cutoffs = 0;
  /// Impacts in sequences (ImpactOrder::sequential); pairs that approach equally fast are one impact.
  long sequential_impacts = 0;
  double contact_residual = 0;  ///< largest residual of a contact solution, m/s
  double contact_overlap = 0;   ///< largest overlap, m, that accepted steps left after separating the parts
  /// Of accepted steps: the residual, and the overlap after the parts were separated, whose ratio of value to
  /// tolerance is largest. The overlaps of bodies that overlapped at time 0 and are not yet separated count,
  /// too.
  ContactViolation worst_residual{}, worst_overlap{};

  /// Adds counts, and keeps the larger errors of contact.
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
    sequential_impacts += other.sequential_impacts;
    contact_residual = std::max(contact_residual, other.contact_residual);
    contact_overlap = std::max(contact_overlap, other.contact_overlap);
    worst_residual.keep_worse(other.worst_residual);
    worst_overlap.keep_worse(other.worst_overlap);
    return *this;
  }
};

}  // namespace pliant
