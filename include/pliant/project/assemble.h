// Assembly before time 0: joins parts that are far apart, rotated and deformed. The flow has no inertia. Each
// step minimises, linearised,
//   1/2 (q_s - rest)^T K_s (q_s - rest) + eps/2 |delta|_M^2   subject to   C = 0, Eq. (12).
// The cost eps of rigid motion is small, so that rigid motion comes first, and the parameters change only by
// as much as their stiffness allows. Rotation costs more while gaps are wide.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

struct AssemblyReport {
  int iterations = 0;     ///< largest number over the islands
  bool converged = true;  ///< false if all gaps closed but the shapes did not converge
  double gap_before = 0;  ///< largest gap before, m
  double gap = 0;         ///< largest gap after, m
};

/// Assembles the islands in which an acting joint is open. Other islands do not change by a bit. Throws
/// UnsatisfiableModel with the name of the joint that cannot close.
AssemblyReport assemble(const Dynamics& dynamics, State& state);

}  // namespace pliant
