// Bodies of joint_switching.h.
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/project/joint_switching.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <pliant/body/step_failure.h>
#include <pliant/project/project.h>

namespace pliant {

namespace projection {

/// Distance of just_before() and just_after() from a kink, in units of the last place.
inline constexpr double kBeside = 2;

/// An impulse below this share of the momentum of the lightest part is rounding.
inline constexpr double kImpulseRounding = 1e-9;

/// Returns the momentum (N s) of the lightest part of a joint at the largest speed of its parts, or at the
/// closing speed of the joint.
inline double momentum(const Model& model, const JointModel& joint, const VecX<double>& v) {
  double mass = std::numeric_limits<double>::infinity(),
         speed = model.body().stabilization.rate * joint.length;
  for (const JointSide& side : joint.sides) {
    const PartModel& m = model.parts()[static_cast<std::size_t>(side.part)];
    mass = std::min(mass, m.part->total_mass());
    speed = std::max(speed, v.segment<3>(m.v0).norm() + m.part->size() * v.segment<3>(m.v0 + 3).norm());
  }
  return mass * speed;
}

}  // namespace projection

PLIANT_INLINE double just_before(double kink) {
  return kink - projection::kBeside * std::numeric_limits<double>::epsilon() * std::abs(kink);
}
PLIANT_INLINE double just_after(double kink) {
  return kink + projection::kBeside * std::numeric_limits<double>::epsilon() * std::abs(kink);
}

PLIANT_INLINE double JointSwitching::after_kink(double t, double near) const {
  const Kink kink = dynamics_.model().next_kink(t - near, t + near);
  return std::isfinite(kink.time) ? std::max(t, just_after(kink.time)) : t;
}

PLIANT_INLINE void JointSwitching::switch_at(StepContext& step, double near) {
  State& state = step.state;
  const Model& model = dynamics_.model();
  if (!state.q.allFinite() || !state.v.allFinite()) return;
  std::vector<bool> more(model.islands().size());
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const JointModel& joint = model.joints()[j];
    const bool on = joint.joint->acts_at(step.t + near), was_on = state.joints[j] != JointMode::off;
    if (on == was_on) continue;
    state.joints[j] = on ? JointMode::closing : JointMode::off;
    wake(state, model.islands()[static_cast<std::size_t>(joint.island)].parts.front());
    if (on) more[static_cast<std::size_t>(joint.island)] = true;
  }
  if (std::find(more.begin(), more.end(), true) != more.end()) engage(step, more);
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

PLIANT_INLINE void JointSwitching::follow_paths(StepContext& step, double kink, double near) {
  const State& state = step.state;
  const Model& model = dynamics_.model();
  if (!state.q.allFinite() || !state.v.allFinite()) return;
  std::vector<bool> moved(model.islands().size());
  for (const int j : model.driven_joints()) {
    const JointModel& joint = model.joints()[static_cast<std::size_t>(j)];
    const JointMode mode = state.joints[static_cast<std::size_t>(j)];
    const Kink of_joint = model.next_kink(joint, kink - near, kink + near);
    if (mode == JointMode::off || !std::isfinite(of_joint.time)) continue;
    if (of_joint.jumps && mode == JointMode::closed) {
      std::ostringstream message;
      message
          << "at t = " << kink << " s " << joint.joint->type() << " '" << joint.joint->name()
          << "' would be torn open: the path of its end jumps in place; expected one whose rate alone may "
             "jump";
      throw UnsatisfiableModel(message.str(), kink);
    }
    moved[static_cast<std::size_t>(joint.island)] = true;
  }
  const VecX<double> v_before = step.state.v;
  VecX<double> impulses = VecX<double>::Zero(model.n_rows());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (!moved[i]) continue;
    pliant::follow_paths(step, model.islands()[i], impulses);
    record(step, model.islands()[i], true, v_before, impulses);
  }
}

/// Records the impulses of an island. step.work: an evaluation of the island at step.t.
PLIANT_INLINE void JointSwitching::record(StepContext& step, const Island& island, bool of_path,
                                          const VecX<double>& v_before, const VecX<double>& impulses) {
  const double t = step.t;
  const Model& model = dynamics_.model();
  auto record_of = [&](int j) {
    const JointModel& joint = model.joints()[static_cast<std::size_t>(j)];
    if (impulses.segment(joint.row, joint.rows).isZero(0)) return;
    const Wrench impulse = dynamics_.joint_wrench(t, j, step.work, impulses);
    const double size = impulse.force.norm() + impulse.torque.norm() / joint.length;
    if (size > projection::kImpulseRounding * std::max(projection::momentum(model, joint, v_before),
                                                       projection::momentum(model, joint, step.state.v)))
      impulses_.push_back({t, j, impulse, of_path});
  };
  std::for_each(island.joints.begin(), island.joints.end(), record_of);
  std::for_each(island.strings.begin(), island.strings.end(), record_of);
}

PLIANT_INLINE void JointSwitching::undo_step() {
  impulses_.resize(std::min(impulses_.size(), at_begin_));
}

PLIANT_INLINE void JointSwitching::forget_after(double t) {
  const auto later = [&](const ImpulseOnEngage& impulse) { return impulse.time > t; };
  impulses_.erase(std::remove_if(impulses_.begin(), impulses_.end(), later), impulses_.end());
}

}  // namespace pliant
