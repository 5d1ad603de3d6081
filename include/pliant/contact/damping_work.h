// The work of drag and dampers during a motion that contact impulses correct. The motion without impulses has
// other velocities than the corrected one: a body at rest falls a little, and its drag and dampers do work
// that the corrected motion does not have.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

class DampingWork {
 public:
  /// before, free: the states at the start and at the end, at time t (s), of a motion of h seconds without
  /// impulses. parts: those that the impulses move. Parts that deform locally are left out.
  DampingWork(const Dynamics& dynamics, const State& before, const State& free, const std::vector<int>& parts,
              double t, double h);
  /// Whether a moved part has drag, damping or a damper.
  bool acts() const { return !damped_.empty() || !at_dampers_.empty(); }
  /// Corrects the works of damping, drag and dampers of springs and drives in the state after the impulses.
  /// All other forces count as constant in time, and the impulses too.
  void correct(State& after);

 private:
  using Works = Vec3<double>;  // of damping, drag, and dampers of springs and drives, J

  void find_dampers(const std::vector<int>& moved);
  Works works(const VecX<double>& v_end);

  const Dynamics& dynamics_;
  const VecX<double>& v_before_;
  const VecX<double> q_;  // at the end of the motion without impulses
  double t_, h_;
  std::vector<int> damped_;      // the parts with drag or damping
  std::vector<int> at_dampers_;  // the parts at springs and drives; empty if no damper is at a moved part
  Workspace<double> work_;
  Works without_impulses_ = Works::Zero();
};

}  // namespace pliant
