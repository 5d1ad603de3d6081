// Function bodies of joint_switching.h: impulses at the times at which joints begin to act, and at kinks of
// prescribed paths.
#pragma once

#include <pliant/project/joint_switching.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <pliant/body/step_failure.h>
#include <pliant/math/header_only.h>
#include <pliant/project/project.h>

namespace pliant {

namespace projection {

/// Distance of just_before() and just_after() from a kink at time t, in units of the machine epsilon times
/// |t|.
inline constexpr double kKinkMargin = 2;

/// An impulse up to this share of impulse_scale() is a rounding error and is not recorded.
inline constexpr double kImpulseRounding = 1e-9;

/// Returns a scale of the impulses of a joint, N s: a mass times a speed. The mass is the mass of the
/// lightest part of the joint. The speed is the largest speed of these parts, and at least
/// Stabilization::rate times the length of the joint.
inline double impulse_scale(const Model& model, const JointModel& joint, const VecX<double>& v) {
  double mass = std::numeric_limits<double>::infinity(),
         speed = model.body().stabilization.rate * joint.length;
  for (const JointSide& side : joint.sides) {
    const PartModel& m = model.parts()[static_cast<std::size_t>(side.part)];
    mass = std::min(mass, m.part->total_mass());
    speed = std::max(speed, v.segment<3>(m.v0).norm() + m.size * v.segment<3>(m.v0 + 3).norm());
  }
  return mass * speed;
}

}  // namespace projection

PLIANT_INLINE double just_before(double kink) {
  return kink - projection::kKinkMargin * std::numeric_limits<double>::epsilon() * std::abs(kink);
}
PLIANT_INLINE double just_after(double kink) {
  return kink + projection::kKinkMargin * std::numeric_limits<double>::epsilon() * std::abs(kink);
}

PLIANT_INLINE double JointSwitching::after_kink(double t, double tolerance) const {
  const Kink kink = dynamics_.model().next_kink(t - tolerance, t + tolerance);
  return std::isfinite(kink.time) ? std::max(t, just_after(kink.time)) : t;
}

PLIANT_INLINE void JointSwitching::switch_at(StepContext& step, double tolerance) {
  State& state = step.state;
  const Model& model = dynamics_.model();
  if (!state.q.allFinite() || !state.v.allFinite()) return;
  std::vector<bool> engaging(model.islands().size());
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const JointModel& joint = model.joints()[j];
    const bool on = joint.joint->acts_at(step.t + tolerance), was_on = state.joints[j] != JointMode::off;
    if (on == was_on) continue;
    state.joints[j] = on ? JointMode::closing : JointMode::off;
    wake(state, model.islands()[static_cast<std::size_t>(joint.island)].parts.front());
    if (on) engaging[static_cast<std::size_t>(joint.island)] = true;
  }
  if (std::find(engaging.begin(), engaging.end(), true) != engaging.end()) engage(step, engaging);
}

PLIANT_INLINE void JointSwitching::engage(StepContext& step, const std::vector<bool>& islands) {
  const Model& model = dynamics_.model();
  const VecX<double> v_before = step.state.v;
  VecX<double> impulses = VecX<double>::Zero(model.n_rows());
  Workspace<double> scratch;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (!islands[i]) continue;
    engage_joints(step, model.islands()[i], scratch, impulses);
    record(step, model.islands()[i], false, v_before, impulses);
  }
}

PLIANT_INLINE void JointSwitching::follow_paths(StepContext& step, double kink, double tolerance) {
  const State& state = step.state;
  const Model& model = dynamics_.model();
  if (!state.q.allFinite() || !state.v.allFinite()) return;
  std::vector<bool> at_kink(model.islands().size());
  for (const int j : model.driven_joints()) {
    const JointModel& joint = model.joints()[static_cast<std::size_t>(j)];
    const JointMode mode = state.joints[static_cast<std::size_t>(j)];
    const Kink joint_kink = model.next_kink(joint, kink - tolerance, kink + tolerance);
    if (mode == JointMode::off || !std::isfinite(joint_kink.time)) continue;
    if (joint_kink.jumps && mode == JointMode::closed) {
      std::ostringstream message;
      message << "at t = " << kink << " s " << joint.joint->type() << " '" << joint.joint->name()
              << "' would be torn open: the path of its end jumps; expected a continuous path, whose rate "
                 "may jump";
      throw UnsatisfiableModel(message.str(), kink);
    }
    at_kink[static_cast<std::size_t>(joint.island)] = true;
  }
  const VecX<double> v_before = step.state.v;
  VecX<double> impulses = VecX<double>::Zero(model.n_rows());
  for (std::size_t i = 0; i < at_kink.size(); ++i) {
    if (!at_kink[i]) continue;
    pliant::follow_paths(step, model.islands()[i], impulses);
    record(step, model.islands()[i], true, v_before, impulses);
  }
}

/// Records the impulses of an island, except rounding errors. v_before: the velocities before the impulses.
/// impulses: on the rows of all joints, N s. step.work: an evaluation of the island at step.t.
PLIANT_INLINE void JointSwitching::record(StepContext& step, const Island& island, bool of_path,
                                          const VecX<double>& v_before, const VecX<double>& impulses) {
  const double t = step.t;
  const Model& model = dynamics_.model();
  auto record_joint = [&](int j) {
    const JointModel& joint = model.joints()[static_cast<std::size_t>(j)];
    if (impulses.segment(joint.row, joint.rows).isZero(0)) return;
    const Wrench impulse = dynamics_.joint_wrench(t, j, step.work, impulses);
    const double size = impulse.force.norm() + impulse.torque.norm() / joint.length;
    if (size > projection::kImpulseRounding * std::max(projection::impulse_scale(model, joint, v_before),
                                                       projection::impulse_scale(model, joint, step.state.v)))
      impulses_.push_back({t, j, impulse, of_path});
  };
  std::for_each(island.joints.begin(), island.joints.end(), record_joint);
  std::for_each(island.strings.begin(), island.strings.end(), record_joint);
}

PLIANT_INLINE void JointSwitching::undo_step() {
  impulses_.resize(std::min(impulses_.size(), count_at_begin_));
}

PLIANT_INLINE void JointSwitching::forget_after(double t) {
  const auto later = [&](const ImpulseOnEngage& impulse) { return impulse.time > t; };
  impulses_.erase(std::remove_if(impulses_.begin(), impulses_.end(), later), impulses_.end());
}

}  // namespace pliant
