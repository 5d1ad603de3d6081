// Assembly before time 0 joins parts that are far apart, rotated and deformed. There are no inertial forces.
// Each step of the iteration solves this problem, linearised: minimise
//   1/2 (q_s - rest)^T K_s (q_s - rest) + eps/2 |delta|_M^2   subject to   C = 0, Eq. (12).
// delta is the step of (c, theta, q_s), and |delta|_M^2 = delta^T M delta. The energy of a continuum
// (part/continuum.h) is added to the first term. The cost eps (1/s^2) of rigid motion is small, so that the
// parameters change little where rigid motion can close the gaps. The inertia of rotation in M is increased
// while gaps are wide.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

struct AssemblyReport {
  int iterations = 0;     ///< largest number of iterations of an island
  bool converged = true;  ///< false if all gaps closed but the shapes did not converge
  double gap_before = 0;  ///< largest gap before the assembly, m
  double gap = 0;         ///< largest gap after the assembly, m
};

/// Assembles the islands (groups of parts that joints connect) in which an acting joint has a gap above
/// kClosedGap times the size of its smaller part (project/project.h). The coordinates of other islands keep
/// all their bits. Sets State::at_limit of all parameters. Returns the largest gaps and the largest number of
/// iterations of all islands. Throws UnsatisfiableModel with the name of the joint that cannot close, and
/// NumericalFailure if a gap is not finite.
AssemblyReport assemble(const Dynamics& dynamics, State& state);

}  // namespace pliant
