// Assembly before time 0: a consistent start from parts that are far apart, rotated and deformed. The flow
// has no inertia; each step minimises
//   1/2 (q_s - rest) K_s (q_s - rest) + eps/2 |delta|_M^2   subject to   C = 0
// linearised. Rigid motion comes first, and global parameters change only as far as their stiffness allows.
// Rotation costs more while gaps are wide.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

struct AssemblyReport {
  int iterations = 0;     ///< largest number over the islands
  bool converged = true;  ///< false if all gaps closed but the shapes did not converge
  double gap_before = 0;  ///< widest gap before, m
  double gap = 0;         ///< widest gap after, m
};

/// Assembles the islands in which an acting joint is open. Other islands do not change, to the last bit.
/// Throws UnsatisfiableModel, naming the joint that cannot close.
AssemblyReport assemble(const Dynamics& dynamics, State& state);

}  // namespace pliant
