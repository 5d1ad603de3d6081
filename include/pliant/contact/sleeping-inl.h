// Function bodies of sleeping.h: times at rest, drives that wake sleeping parts, and the sets of parts that
// fall asleep together.
#pragma once

#include <pliant/contact/sleeping.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <pliant/body/speed_scale.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace sleeping {

/// The end of a step and the start of the next may differ by kTimeTolerance of the length plus kTimeUlps
/// units in the last place of the time. A change of a drive (Drive in sleeping.h) near both times belongs to
/// the second step: a load that changes after the first step has no influence on the first step.
inline constexpr double kTimeTolerance = 1e-9, kTimeUlps = 16;

/// Returns whether a vector changes within h seconds after t: whether its values at t, t + h / 2 and t + h
/// differ.
inline bool differs(const TimeVector& x, double t, double h) {
  const Vec3<double> now = x.value(t);
  return x.value(t + h) != now || x.value(t + 0.5 * h) != now;
}

/// Returns whether a function changes within h seconds after t, as above. A function of the state may always
/// change.
inline bool differs(const StateFunction& x, double t, double h) {
  if (x.reads_state()) return true;
  const double now = x.of_time().value(t);
  return x.of_time().value(t + h) != now || x.of_time().value(t + 0.5 * h) != now;
}
/// Returns whether a function of a distributed force changes within h seconds after t while its part is at
/// rest. Quantities at points of the part are then constant.
inline bool differs_at_rest(const StateFunction& x, double t, double h) {
  const std::vector<Signal>& signals = x.signals();
  const bool of_points = x.reads_state() && !x.formula().reads_time() &&
                         std::all_of(signals.begin(), signals.end(), [](const Signal& signal) {
                           return signal.kind == Signal::Kind::at_point;
                         });
  return !of_points && differs(x, t, h);
}
inline bool differs(const StateVector& x, double t, double h) {
  return differs(x.component[0], t, h) || differs(x.component[1], t, h) || differs(x.component[2], t, h);
}

/// Returns whether a point has prescribed motion: a moving point of the world, or a point of a part with
/// prescribed motion.
inline bool is_prescribed(const Point& point) {
  return point.part == nullptr ? !point.world.is_constant() : point.part->motion() != nullptr;
}
/// Returns whether the prescribed motion of a part moves or rotates the part within h seconds after t; the
/// poses at t, t + h / 2 and t + h are compared.
inline bool moves(const Part& part, double t, double h) {
  const PrescribedMotion* motion = part.motion();
  if (motion == nullptr) return false;
  const MovingFrame now = motion->at(t), half = motion->at(t + 0.5 * h), then = motion->at(t + h);
  return now.c != then.c || now.R != then.R || now.c != half.c || now.R != half.R;
}
/// Returns whether the prescribed motion of a point moves it within h seconds after t. For a point of a part
/// it returns whether the prescribed motion of the part moves or rotates the part.
inline bool moves(const Point& point, double t, double h) {
  return point.part == nullptr ? differs(point.world, t, h) : moves(*point.part, t, h);
}

/// Returns whether a spring acts in the middle of the h seconds after t and an end with prescribed motion
/// moves. Times at the ends of the step are not compared, because another motion may begin there.
inline bool pulls(const Spring& spring, const Point& end, double t, double h) {
  return spring.acts_at(t + 0.5 * h) && moves(end, t + 0.25 * h, 0.5 * h);
}

/// Returns whether a torque can change in time: by its value, or because its axes are those of a part with
/// prescribed motion.
inline bool is_prescribed(const Torque& torque) {
  return !torque.torque.is_constant() || (torque.frame == Frame::body && torque.part->motion() != nullptr);
}
/// Returns whether a torque that is_prescribed() changes within h seconds after t.
inline bool changes(const Torque& torque, double t, double h) {
  return differs(torque.torque, t, h) || (torque.frame == Frame::body && moves(*torque.part, t, h));
}

}  // namespace sleeping

PLIANT_INLINE Sleeping::Sleeping(const Dynamics& dynamics, RestingContacts& resting, const MeshFinder& meshes)
    : dynamics_(dynamics),
      model_(dynamics.model()),
      resting_(resting),
      meshes_(meshes),
      settings_(model_.n_resting() > 0 ? &*model_.body().contact.sleep : nullptr) {
  if (settings_ == nullptr) return;
  if (!(settings_->speed > 0) || !std::isfinite(settings_->speed) || !(settings_->after > 0) ||
      !std::isfinite(settings_->after)) {
    std::ostringstream message;
    message << "contact: bodies fall asleep below a speed of " << settings_->speed << " m/s after "
            << settings_->after << " s; expected a finite speed and a finite time above 0";
    throw std::invalid_argument(message.str());
  }
  for (std::size_t i = 0; i < model_.parts().size(); ++i)
    if (model_.parts()[i].q0 >= 0) moving_.push_back(static_cast<int>(i));
  find_drives();
  find_switches();
}

/// Adds a Drive (sleeping.h) for each muscle, and for each drive of a joint or parameter that is not passive.
PLIANT_INLINE void Sleeping::find_actuation() {
  auto has = [&](int part) { return part >= 0 && model_.parts()[at(part)].q0 >= 0; };
  for (const SpringModel& s : model_.springs())
    for (const int end : {s.a.part, s.b.part})
      if (has(end) && !s.functions.empty())
        drives_.push_back({end, [spring = s.spring](double t, double h) {
                             return sleeping::differs(spring->stiffness, t, h) ||
                                    sleeping::differs(spring->damping, t, h) ||
                                    sleeping::differs(spring->rest_length, t, h);
                           }});
  for (const DriveModel& m : model_.drives()) {
    std::vector<int> parts;
    model_.append_parts(m.on, parts);
    for (const int part : parts)
      if (has(part) && !m.drive->is_passive())
        drives_.push_back({part, [drive = m.drive](double t, double h) {
                             return sleeping::differs(drive->target, t, h) ||
                                    (drive->target_rate && sleeping::differs(*drive->target_rate, t, h)) ||
                                    sleeping::differs(drive->stiffness, t, h) ||
                                    sleeping::differs(drive->damping, t, h) ||
                                    sleeping::differs(drive->force, t, h);
                           }});
  }
}

/// Adds a Drive (sleeping.h) for each cause that may change: rest values, factors of local stiffness, forces,
/// torques, springs, drives of joints and parameters, prescribed motions at springs and joints, and gravity.
PLIANT_INLINE void Sleeping::find_drives() {
  for (const int i : moving_) {
    const PartModel& m = model_.parts()[at(i)];
    if (m.actuated)
      drives_.push_back({i, [&m](double t, double h) {
                           const VecMax<double> now = m.rest_at(t);
                           return m.rest_at(t + h) != now || m.rest_at(t + 0.5 * h) != now;
                         }});
    if (const TimeFunction* factor = m.part->local_factor(); factor != nullptr && !factor->is_constant())
      drives_.push_back({i, [factor](double t, double h) { return sleeping::differs(*factor, t, h); }});
  }
  auto has = [&](int part) { return part >= 0 && model_.parts()[at(part)].q0 >= 0; };
  for (const ForceModel& f : model_.forces()) {
    if (!has(f.at.part)) continue;
    if (f.force->custom)
      drives_.push_back({f.at.part, [](double, double) { return true; }});
    else if (!f.force->force.is_constant())
      drives_.push_back(
          {f.at.part, [&f](double t, double h) { return sleeping::differs(f.force->force, t, h); }});
  }
  for (const DistributedModel& m : model_.distributed_forces()) {
    if (m.force->density.is_constant() && m.force->pressure.is_constant()) continue;
    drives_.push_back({m.part, [force = m.force](double t, double h) {
                         const auto& f = force->density.component;
                         return std::any_of(f.begin(), f.end(),
                                            [&](const StateFunction& component) {
                                              return sleeping::differs_at_rest(component, t, h);
                                            }) ||
                                sleeping::differs_at_rest(force->pressure, t, h);
                       }});
  }
  for (const TorqueModel& torque : model_.torques())
    for (const int end : {torque.part, torque.against})
      if (has(end) && sleeping::is_prescribed(*torque.torque))
        drives_.push_back(
            {end, [&torque](double t, double h) { return sleeping::changes(*torque.torque, t, h); }});
  for (const SpringModel& s : model_.springs())
    for (const auto& [end, other] : {std::pair(s.a.part, &s.spring->b), std::pair(s.b.part, &s.spring->a)})
      if (has(end) && sleeping::is_prescribed(*other))
        drives_.push_back({end, [spring = s.spring, far = other](double t, double h) {
                             return sleeping::pulls(*spring, *far, t, h);
                           }});
  find_actuation();
  for (const int j : model_.driven_joints()) {
    const JointModel& joint = model_.joints()[at(j)];
    drives_.push_back({joint.sides.front().part, [&joint](double t, double h) {
                         const std::vector<Point>& points = joint.joint->points();
                         return std::any_of(points.begin(), points.end(),
                                            [&](const Point& point) { return sleeping::moves(point, t, h); });
                       }});
  }
  if (model_.body().changing_gravity)
    drives_.push_back({-1, [this](double t, double h) {
                         return sleeping::differs(*model_.body().changing_gravity, t, h);
                       }});
}

/// Finds the joints, planes and obstacles that act for a limited time.
PLIANT_INLINE void Sleeping::find_switches() {
  for (const JointModel& joint : model_.joints())
    if (joint.joint->on() > 0 || std::isfinite(joint.joint->off()))
      drives_.push_back({joint.sides.front().part, [switched = joint.joint](double t, double h) {
                           return switched->acts_at(t) != switched->acts_at(t + h);
                         }});
  auto add = [&](const auto& objects) {
    for (const auto& object : objects)
      if (object.on > 0 || std::isfinite(object.off))
        drives_.push_back({-1, [&object](double t, double h) {
                             return object.acts_before(t) != object.acts_before(t + h);
                           }});
  };
  add(model_.body().contact.planes);
  add(model_.body().contact.obstacles);
}

PLIANT_INLINE void Sleeping::begin_motion(double t, double h, State& state) {
  q_.resize(0);
  auto any_sleeps = [&] {
    return std::any_of(state.at_rest.begin(), state.at_rest.end(), [](double rested) { return rested < 0; });
  };
  if (settings_ == nullptr || !any_sleeps()) return;
  for (const int i : moving_) {
    const PartModel& m = model_.parts()[at(i)];
    if (sleeps(state, i) && !state.v.segment(m.v0, m.n_v()).isZero(0)) wake(state, i);
  }
  const double tolerance = sleeping::kTimeTolerance * h + sleeping::kTimeUlps *
                                                              std::numeric_limits<double>::epsilon() *
                                                              std::max(std::abs(t), std::abs(t + h));
  for (const Drive& drive : drives_) {
    if (drive.part >= 0 && !sleeps(state, drive.part)) continue;
    if (!drive.changes(t - tolerance, h)) continue;
    if (drive.part >= 0)
      wake(state, drive.part);
    else
      for (const int i : moving_) wake(state, i);
  }
  if (any_sleeps()) q_ = state.q;
}

PLIANT_INLINE void Sleeping::restore(State& state) const {
  if (!any_asleep()) return;
  for (const int i : moving_) {
    if (!sleeps(state, i)) continue;
    const PartModel& m = model_.parts()[at(i)];
    state.q.segment(m.q0, m.n_q()) = q_.segment(m.q0, m.n_q());
    state.v.segment(m.v0, m.n_v()).setZero();
  }
}

PLIANT_INLINE bool Sleeping::touches_sleeping(const std::vector<Contact>& contacts,
                                              const State& state) const {
  auto asleep = [&](const ContactSide& side) { return side.part >= 0 && sleeps(state, side.part); };
  return any_asleep() && std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
           return asleep(contact.a) || asleep(contact.b);
         });
}

PLIANT_INLINE void Sleeping::wake_touched(const std::vector<Contact>& contacts, State& state) const {
  for (const Contact& contact : contacts)
    for (const int part : {contact.a.part, contact.b.part})
      if (part >= 0) wake(state, part);
}

PLIANT_INLINE void Sleeping::wake_moved(State& state) const {
  if (!any_asleep()) return;
  for (const int i : moving_) {
    const PartModel& m = model_.parts()[at(i)];
    if (sleeps(state, i) && (state.q.segment(m.q0, m.n_q()) != q_.segment(m.q0, m.n_q()) ||
                             !state.v.segment(m.v0, m.n_v()).isZero(0)))
      wake(state, i);
  }
}

/// Returns an estimate of the largest speed of a material point of a part, m/s. The angular velocity
/// and the rates of parameters that are not lengths are multiplied by the size of the part. The largest rate
/// of a local displacement is added.
PLIANT_INLINE double Sleeping::speed(const State& state, int part) const {
  const PartModel& m = model_.parts()[at(part)];
  const auto v = state.v.segment(m.v0, m.n_v());
  const double size = m.size;
  double speed = v.head<3>().norm() + size * v.segment<3>(3).norm() + shape_speed(m, v, size);
  if (m.local != nullptr)
    speed += m.local->displacements(state.v.data() + m.v0 + 6 + m.n_s).rowwise().norm().maxCoeff();
  return speed;
}

/// Adds h seconds to the time at rest of each part that is at rest, up to Sleep::after. Sets the time at rest
/// of moving parts to zero. Sleeping parts do not change. Returns whether a part has been at rest for long
/// enough to sleep.
PLIANT_INLINE bool Sleeping::update_rest_times(double h, State& state) const {
  bool any = false;
  for (const int i : moving_) {
    double& rested = state.at_rest[at(i)];
    if (rested < 0) continue;
    rested = speed(state, i) <= settings_->speed ? std::min(rested + h, settings_->after) : 0;
    any = any || rested >= settings_->after;
  }
  return any;
}

PLIANT_INLINE bool Sleeping::is_kinematic(const ContactSide& side, int plane) const {
  if (side.part >= 0) return model_.parts()[at(side.part)].motion != nullptr;
  return plane >= 0 && !model_.body().contact.planes[at(plane)].point.is_constant();
}

/// Returns the sets of parts that touch each other or are connected by joints, springs or torques.
PLIANT_INLINE DisjointSets Sleeping::connected_parts(const std::vector<Contact>& contacts) const {
  auto has = [&](int part) { return part >= 0 && model_.parts()[at(part)].q0 >= 0; };
  DisjointSets sets = model_.connected_parts();
  for (const Contact& contact : contacts)
    if (has(contact.a.part) && has(contact.b.part)) sets.unite(contact.a.part, contact.b.part);
  return sets;
}

PLIANT_INLINE void Sleeping::fall_asleep(const std::vector<Contact>& contacts, double t, double h,
                                         State& state) {
  if (settings_ == nullptr || !update_rest_times(h, state)) return;
  std::vector<Contact> touching = contacts;
  const std::vector<Contact>& near = resting_.near(state, t + h);
  touching.insert(touching.end(), near.begin(), near.end());
  meshes_.find(state, t + h, touching);
  DisjointSets sets = connected_parts(touching);
  std::vector<bool> awake(model_.parts().size());
  auto keep_awake = [&](int part) {
    if (part >= 0) awake[at(sets.root(part))] = true;
  };
  // A part stays awake if a part or plane with prescribed motion touches it.
  for (const Contact& contact : touching) {
    if (is_kinematic(contact.b, contact.plane)) keep_awake(contact.a.part);
    if (is_kinematic(contact.a, -1)) keep_awake(contact.b.part);
  }
  for (const Drive& drive : drives_) {
    if (!drive.changes(t, h)) continue;
    if (drive.part < 0) return;
    keep_awake(drive.part);
  }
  for (const int i : moving_)
    if (state.at_rest[at(i)] >= 0 && state.at_rest[at(i)] < settings_->after) keep_awake(i);
  std::vector<int> falling;
  for (const int i : moving_) {
    const int root = sets.root(i);
    if (sleeps(state, i) || awake[at(root)]) continue;
    state.at_rest[at(i)] = -1 - root;
    falling.push_back(i);
  }
  if (falling.empty()) return;
  Workspace<double> scratch;
  const double energy = dynamics_.energy(t + h, state.q, state.v, falling, scratch);
  for (const int i : falling) {
    const PartModel& m = model_.parts()[at(i)];
    state.v.segment(m.v0, m.n_v()).setZero();
  }
  state.work[static_cast<int>(Work::contact)] +=
      dynamics_.energy(t + h, state.q, state.v, falling, scratch) - energy;
}

}  // namespace pliant
