// The work of drag and dampers during a motion that contact impulses correct. The motion without impulses has
// other velocities than the corrected one: a body at rest falls a little, and its drag and dampers do work
// that the corrected motion does not have.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

class DampingWork {
 public:
  /// Velocities at the start of the motion, which must outlive the object.
  struct Starts {
    const VecX<double>& free;       ///< with predicted impulses (predicted_impulses.h)
    const VecX<double>* corrected;  ///< before predicted impulses; nullptr: there are none
  };
  /// free: the state at the end of a motion of h seconds, before the impulses at its end. t: time at the end,
  /// s. parts: the parts that the impulses move, sorted. Drag and damping of parts that deform locally are
  /// left out.
  DampingWork(const Dynamics& dynamics, const Starts& starts, const State& free,
              const std::vector<int>& parts, double t, double h);
  /// Whether a moved part has drag, damping or a damper.
  bool acts() const { return !damped_.empty() || !springs_.empty() || !drives_.empty(); }
  /// Corrects the works of damping, drag and dampers of springs and drives. after: the state after the
  /// impulses. All other forces, and the forces of the impulses, are assumed constant in time. The work of
  /// moving anchors at dampers is not corrected.
  void correct(State& after);

 private:
  using Works = Vec3<double>;  // of damping, drag, and dampers of springs and drives, J

  void find_dampers(const std::vector<int>& moved);
  Works works(const VecX<double>& v_start, const VecX<double>& v_end);

  const Dynamics& dynamics_;
  const Starts starts_;
  VecX<double> q_;  // at the end of the motion without impulses
  double t_, h_;
  std::vector<int> damped_;                  // the moved parts with drag or damping
  std::vector<const SpringModel*> springs_;  // with dampers, at moved parts
  std::vector<const DriveModel*> drives_;    // with dampers, at moved parts
  std::vector<int> at_dampers_;  // the parts at these springs and drives, and those that their functions read
  Workspace<double> work_;
  Works without_impulses_ = Works::Zero();
};

}  // namespace pliant
