// Joints that begin or stop acting during a run, and joints whose ends follow prescribed paths with kinks.
#pragma once

#include <cstddef>
#include <vector>

#include <pliant/body/step_context.h>

namespace pliant {

/// The impulse of a joint on its first side (a part, or the world). The impulse arises when this joint, or
/// another joint of its island, begins to act and the velocities of the parts violate the joint. It also
/// arises when the rate of a prescribed path jumps.
struct ImpulseOnEngage {
  double time;           ///< s
  int joint;             ///< number in the model
  Wrench impulse;        ///< N s and N m s, world, about the first point of the joint
  bool of_path = false;  ///< whether the rate of a path jumped
};

/// Return times (s) just before and just after a kink of a path, where steps end and begin.
double just_before(double kink);
double just_after(double kink);

class JointSwitching {
 public:
  /// The dynamics must outlive this object.
  explicit JointSwitching(const Dynamics& dynamics) : dynamics_(dynamics) {}

  /// Returns t (s). If a path has a kink within the tolerance (s) of t, returns the later of t and the time
  /// just after the kink.
  double after_kink(double t, double tolerance) const;
  /// Engages the joints that begin to act at step.t, releases the joints that stop acting, and wakes their
  /// islands. A switching time that is later than step.t by at most the tolerance (s) is regarded as reached.
  /// Does nothing if the state is not finite.
  void switch_at(StepContext& step, double tolerance);
  /// Engages the joints of the marked islands by engage_joints() (project/project.h). If the settings project
  /// closed joints, joints of JointMode::closing with a small gap become closed. Impulses then change the
  /// velocities so that closed joints stay closed. Records the impulses. islands: one mark for each island of
  /// the model.
  void engage(StepContext& step, const std::vector<bool>& islands);
  /// Applies the impulses at a kink (s) of prescribed paths, and at other kinks within the tolerance (s) of
  /// this time. step.t: a time just after the kink. Throws UnsatisfiableModel if the position on the path of
  /// a closed joint jumps. Does nothing if the state is not finite.
  void follow_paths(StepContext& step, double kink, double tolerance);
  /// Returns the recorded impulses in the order of time. Impulses that are rounding errors are not recorded.
  const std::vector<ImpulseOnEngage>& impulses() const { return impulses_; }
  /// undo_step() removes the impulses recorded since begin_step(). forget_after() removes the impulses later
  /// than t, s.
  void begin_step() { count_at_begin_ = impulses_.size(); }
  void undo_step();
  void forget_after(double t);

 private:
  void record(StepContext& step, const Island& island, bool of_path, const VecX<double>& v_before,
              const VecX<double>& impulses);

  const Dynamics& dynamics_;
  std::vector<ImpulseOnEngage> impulses_;
  std::size_t count_at_begin_ = 0;
};

}  // namespace pliant
