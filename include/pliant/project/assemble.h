// Assembly before time 0: a consistent start from parts that lie far apart, turned and misshaped. Without
// inertia, each step is the least
//   1/2 (q_s - rest) K_s (q_s - rest) + eps/2 |delta|_M^2   subject to   C = 0
// linearised, so that rigid motion comes first and global parameters change only as far as their stiffness
// says; turning is dear while gaps are wide (design 1.5).
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

struct AssemblyReport {
  int iterations = 0;  ///< of the island that took most
  bool converged =
      true;  ///< whether shapes converged; else gaps closed, but shapes had not in the most iterations
  double gap_before = 0;  ///< widest, m
  double gap = 0;         ///< widest that is left, m
};

/// Brings the joints that act at the state together, of islands in which one is open. Islands that are
/// assembled stay as they are, to the last bit. Throws UnsatisfiableModel, naming the joint that cannot
/// close.
AssemblyReport assemble(const Dynamics& dynamics, State& state);

}  // namespace pliant
