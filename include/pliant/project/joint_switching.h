// Joints that begin and cease to act in the course of a run, and joints whose ends follow paths with kinks.
#pragma once

#include <cstddef>
#include <vector>

#include <pliant/body/step_context.h>

namespace pliant {

/// What a joint does to its first side (a part, or the world) when it, or another of its island, begins to
/// act on parts whose velocities do not agree with it, or when the rate jumps at which one's ends are moved.
struct ImpulseOnEngage {
  double time;           ///< s
  int joint;             ///< its number in the model
  Wrench impulse;        ///< N s and N m s, about its first point
  bool of_path = false;  ///< whether by a path whose rate jumped
};

/// Steps end and begin beside a kink of a path, on the side that is theirs: times (s) next to it.
double just_before(double kink);
double just_after(double kink);

class JointSwitching {
 public:
  /// The dynamics must outlive it.
  explicit JointSwitching(const Dynamics& dynamics) : dynamics_(dynamics) {}

  /// A time; where a path has a kink there, or nearer to it than `near`, that just after the kink. s.
  double after_kink(double t, double near) const;
  /// Engages and releases joints as their times say at step.t; times nearer than `near` (s) count as equal.
  void switch_at(StepContext& step, double near);
  /// Engages the joints of the islands that are marked.
  void engage(StepContext& step, const std::vector<bool>& islands);
  /// Applies the impulses at a kink (s) of prescribed paths, or at kinks within `near` (s) of it; step.t: a
  /// time just after the kink. Throws UnsatisfiableModel if the path of a closed joint jumps in place.
  void follow_paths(StepContext& step, double kink, double near);
  /// In the order of time; those that are mere rounding are left out.
  const std::vector<ImpulseOnEngage>& impulses() const { return impulses_; }
  /// undo_step() takes back those since begin_step(); forget_after(): those after a time, s.
  void begin_step() { at_begin_ = impulses_.size(); }
  void undo_step();
  void forget_after(double t);

 private:
  void record(StepContext& step, const Island& island, bool of_path, const VecX<double>& v_before,
              const VecX<double>& impulses);

  const Dynamics& dynamics_;
  std::vector<ImpulseOnEngage> impulses_;
  std::size_t at_begin_ = 0;
};

}  // namespace pliant
