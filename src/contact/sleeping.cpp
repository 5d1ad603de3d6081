#include <pliant/contact/sleeping.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <pliant/math/index.h>

namespace pliant {

namespace {

/// Times are equal within this share of a step, and this many units in the last place. A change at the end of
/// a step counts for both steps.
constexpr double kBesideStep = 1e-9, kBesideUlps = 16;

bool differs(const TimeVector& x, double t, double h) {
  const Vec3<double> now = x.value(t);
  return x.value(t + h) != now || x.value(t + 0.5 * h) != now;
}

/// Returns whether the motion of a point is prescribed: of the world, or of a kinematic part.
bool is_prescribed(const Point& point) {
  return point.part == nullptr ? !point.world.is_constant() : point.part->motion() != nullptr;
}
bool moves(const Part& part, double t, double h) {
  const PrescribedMotion* motion = part.motion();
  if (motion == nullptr) return false;
  const MovingFrame now = motion->at(t), half = motion->at(t + 0.5 * h), then = motion->at(t + h);
  return now.c != then.c || now.R != then.R || now.c != half.c || now.R != half.R;
}
bool moves(const Point& point, double t, double h) {
  return point.part == nullptr ? differs(point.world, t, h) : moves(*point.part, t, h);
}

/// Returns whether a torque changes in time, or with the axes of a kinematic part.
bool is_prescribed(const Torque& torque) {
  return !torque.torque.is_constant() || (torque.frame == Frame::body && torque.part->motion() != nullptr);
}
bool changes(const Torque& torque, double t, double h) {
  return differs(torque.torque, t, h) || (torque.frame == Frame::body && moves(*torque.part, t, h));
}

}  // namespace

Sleeping::Sleeping(const Dynamics& dynamics, RestingContacts& resting, const MeshFinder& meshes)
    : dynamics_(dynamics),
      model_(dynamics.model()),
      resting_(resting),
      meshes_(meshes),
      settings_(model_.n_resting() > 0 ? &*model_.body().contact.sleep : nullptr) {
  if (settings_ == nullptr) return;
  if (!(settings_->speed > 0) || !std::isfinite(settings_->speed) || !(settings_->after > 0) ||
      !std::isfinite(settings_->after)) {
    std::ostringstream message;
    message << "contact: sleep at speeds below " << settings_->speed << " m/s for " << settings_->after
            << " s; expected a speed and a time above 0";
    throw std::invalid_argument(message.str());
  }
  for (std::size_t i = 0; i < model_.parts().size(); ++i)
    if (model_.parts()[i].q0 >= 0) moving_.push_back(static_cast<int>(i));
  note_drives();
  note_switches();
}

/// Collects the causes of motion that change in time and act on parts.
void Sleeping::note_drives() {
  for (const int i : moving_) {
    const PartModel& m = model_.parts()[at(i)];
    if (m.actuated)
      drives_.push_back({i, [&m](double t, double h) {
                           const VecMax<double> now = m.rest_at(t);
                           return m.rest_at(t + h) != now || m.rest_at(t + 0.5 * h) != now;
                         }});
  }
  auto has = [&](int part) { return part >= 0 && model_.parts()[at(part)].q0 >= 0; };
  for (const ForceModel& f : model_.forces()) {
    if (!has(f.at.part)) continue;
    if (f.force->custom)
      drives_.push_back({f.at.part, [](double, double) { return true; }});
    else if (!f.force->force.is_constant())
      drives_.push_back({f.at.part, [&f](double t, double h) { return differs(f.force->force, t, h); }});
  }
  for (const TorqueModel& of : model_.torques())
    for (const int end : {of.part, of.against})
      if (has(end) && is_prescribed(*of.torque))
        drives_.push_back({end, [&of](double t, double h) { return changes(*of.torque, t, h); }});
  for (const SpringModel& s : model_.springs())
    for (const auto& [end, other] : {std::pair(s.a.part, &s.spring->b), std::pair(s.b.part, &s.spring->a)})
      if (has(end) && is_prescribed(*other))
        drives_.push_back({end, [far = other](double t, double h) { return moves(*far, t, h); }});
  for (const int j : model_.driven_joints()) {
    const JointModel& joint = model_.joints()[at(j)];
    drives_.push_back({joint.sides.front().part, [&joint](double t, double h) {
                         const std::vector<Point>& points = joint.joint->points();
                         return std::any_of(points.begin(), points.end(),
                                            [&](const Point& point) { return moves(point, t, h); });
                       }});
  }
  if (model_.body().changing_gravity)
    drives_.push_back(
        {-1, [this](double t, double h) { return differs(*model_.body().changing_gravity, t, h); }});
}

/// Collects joints, planes and obstacles that begin or cease to act.
void Sleeping::note_switches() {
  for (const JointModel& joint : model_.joints())
    if (joint.joint->on() > 0 || std::isfinite(joint.joint->off()))
      drives_.push_back({joint.sides.front().part, [of = joint.joint](double t, double h) {
                           return of->acts_at(t) != of->acts_at(t + h);
                         }});
  auto note = [&](const auto& things) {
    for (const auto& thing : things)
      if (thing.on > 0 || std::isfinite(thing.off))
        drives_.push_back(
            {-1, [&thing](double t, double h) { return thing.acts_before(t) != thing.acts_before(t + h); }});
  };
  note(model_.body().contact.planes);
  note(model_.body().contact.obstacles);
}

void Sleeping::begin_motion(double t, double h, State& state) {
  q_.resize(0);
  auto any_sleeps = [&] {
    return std::any_of(state.at_rest.begin(), state.at_rest.end(), [](double rested) { return rested < 0; });
  };
  if (settings_ == nullptr || !any_sleeps()) return;
  for (const int i : moving_) {
    const PartModel& m = model_.parts()[at(i)];
    if (sleeps(state, i) && !state.v.segment(m.v0, m.n_v()).isZero(0)) wake(state, i);
  }
  const double near = kBesideStep * h + kBesideUlps * std::numeric_limits<double>::epsilon() *
                                            std::max(std::abs(t), std::abs(t + h));
  for (const Drive& drive : drives_) {
    if (drive.part >= 0 && !sleeps(state, drive.part)) continue;
    if (!drive.changes(t - near, h + 2 * near)) continue;
    if (drive.part >= 0)
      wake(state, drive.part);
    else
      for (const int i : moving_) wake(state, i);
  }
  if (any_sleeps()) q_ = state.q;
}

void Sleeping::restore(State& state) const {
  if (!any()) return;
  for (const int i : moving_) {
    if (!sleeps(state, i)) continue;
    const PartModel& m = model_.parts()[at(i)];
    state.q.segment(m.q0, m.n_q()) = q_.segment(m.q0, m.n_q());
    state.v.segment(m.v0, m.n_v()).setZero();
  }
}

bool Sleeping::is_met(const std::vector<Contact>& contacts, const State& state) const {
  auto asleep = [&](const ContactSide& side) { return side.part >= 0 && sleeps(state, side.part); };
  return any() && std::any_of(contacts.begin(), contacts.end(),
                              [&](const Contact& contact) { return asleep(contact.a) || asleep(contact.b); });
}

void Sleeping::wake_met(const std::vector<Contact>& contacts, State& state) const {
  for (const Contact& contact : contacts)
    for (const int part : {contact.a.part, contact.b.part})
      if (part >= 0) wake(state, part);
}

void Sleeping::wake_moved(State& state) const {
  if (!any()) return;
  for (const int i : moving_) {
    const PartModel& m = model_.parts()[at(i)];
    if (sleeps(state, i) && (state.q.segment(m.q0, m.n_q()) != q_.segment(m.q0, m.n_q()) ||
                             !state.v.segment(m.v0, m.n_v()).isZero(0)))
      wake(state, i);
  }
}

/// Returns a bound of the speed of all points of a part, m/s. Rates of parameters without a unit of length,
/// and of angles, count as those of a point at the size of the part.
double Sleeping::speed(const State& state, int part) const {
  const PartModel& m = model_.parts()[at(part)];
  const auto v = state.v.segment(m.v0, m.n_v());
  const double size = m.part->size();
  double speed = v.head<3>().norm() + size * v.segment<3>(3).norm() +
                 std::max(1.0, size) * v.segment(6, m.n_s).lpNorm<1>();
  if (m.local != nullptr)
    speed += m.local->displacements(state.v.data() + m.v0 + 6 + m.n_s).rowwise().norm().maxCoeff();
  return speed;
}

/// Adds h seconds to the times at rest. Returns whether any part has been at rest for long enough.
bool Sleeping::note_rest(double h, State& state) const {
  bool any = false;
  for (const int i : moving_) {
    double& rested = state.at_rest[at(i)];
    if (rested < 0) continue;
    rested = speed(state, i) <= settings_->speed ? std::min(rested + h, settings_->after) : 0;
    any = any || rested >= settings_->after;
  }
  return any;
}

bool Sleeping::is_kinematic(const ContactSide& side, int plane) const {
  if (side.part >= 0) return model_.parts()[at(side.part)].motion != nullptr;
  return plane >= 0 && !model_.body().contact.planes[at(plane)].point.is_constant();
}

/// Returns the sets of parts that touch or are tied to each other.
DisjointSets Sleeping::sets_of(const std::vector<Contact>& contacts) const {
  auto has = [&](int part) { return part >= 0 && model_.parts()[at(part)].q0 >= 0; };
  DisjointSets sets(model_.parts().size());
  for (const Contact& contact : contacts)
    if (has(contact.a.part) && has(contact.b.part)) sets.unite(contact.a.part, contact.b.part);
  for (const Island& island : model_.islands())
    for (const int i : island.parts) sets.unite(i, island.parts.front());
  for (const SpringModel& s : model_.springs())
    if (has(s.a.part) && has(s.b.part)) sets.unite(s.a.part, s.b.part);
  for (const TorqueModel& of : model_.torques())
    if (has(of.part) && has(of.against)) sets.unite(of.part, of.against);
  return sets;
}

void Sleeping::fall_asleep(const std::vector<Contact>& contacts, double t, double h, State& state) {
  if (settings_ == nullptr || !note_rest(h, state)) return;
  std::vector<Contact> touching = contacts;
  const std::vector<Contact>& near = resting_.near(state, t + h);
  touching.insert(touching.end(), near.begin(), near.end());
  meshes_.find(state, t + h, touching);
  DisjointSets sets = sets_of(touching);
  std::vector<bool> restless(model_.parts().size());
  auto rouse = [&](int part) {
    if (part >= 0) restless[at(sets.leader(part))] = true;
  };
  // Kinematic parts and moving planes keep the bodies that they touch awake.
  for (const Contact& contact : touching) {
    if (is_kinematic(contact.b, contact.plane)) rouse(contact.a.part);
    if (is_kinematic(contact.a, -1)) rouse(contact.b.part);
  }
  for (const Drive& drive : drives_) {
    if (!drive.changes(t, h)) continue;
    if (drive.part < 0) return;
    rouse(drive.part);
  }
  for (const int i : moving_)
    if (state.at_rest[at(i)] >= 0 && state.at_rest[at(i)] < settings_->after) rouse(i);
  std::vector<int> falling;
  for (const int i : moving_) {
    const int least = sets.leader(i);
    if (sleeps(state, i) || restless[at(least)]) continue;
    state.at_rest[at(i)] = -1 - least;
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
