#include <pliant/integrate/contact_stepping.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include <pliant/integrate/advance.h>
#include <pliant/integrate/settle.h>
#include <pliant/integrate/step_failure.h>

namespace pliant {

namespace {

/// Surfaces that are nearer than this, in sizes of the smaller part, and do not move apart rest on each
/// other.
constexpr double kResting = 1e-6;
/// Impacts of this speed, in units of what gravity gives in a step, do not rebound.
constexpr double kSlow = 1e-3;
/// Most pairs whose impacts in one step are told in time, and most such times in a step.
constexpr std::size_t kMostPairs = 3;
/// Most parts of a step, so that nothing passes through anything.
constexpr double kMostParts = 1e4;
constexpr int kMostEvents = 200;
/// An impact is told in time when the gap is this small, in sizes, or the time known to this part of the
/// step.
constexpr double kGap = 1e-13, kTime = 1e-15;
constexpr int kMostTrials = 60;
/// Points of one contact at the start and the end of a step are nearer than this, in sizes.
constexpr double kSamePoint = 0.2;
/// Bodies that overlap are parted at most at this speed, in sizes of side a a second.
constexpr double kPartingSpeed = 1;
constexpr int kMostPartings = 4;
/// Overlaps below this share of what counts as resting are left.
constexpr double kRounding = 1e-8;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

bool same_pair(const Contact& one, const Contact& other) {
  return one.a.part == other.a.part && one.b.part == other.b.part && one.plane == other.plane;
}

bool has_pair(const std::vector<Contact>& some, const Contact& contact) {
  return std::any_of(some.begin(), some.end(), [&](const Contact& c) { return same_pair(c, contact); });
}

void set_step(State& state, double t, double h) {
  state.start = t;
  state.step = 0;
  state.h = h;
}

}  // namespace

void ContactRecord::clear() {
  contacts.clear();
  impulses.clear();
  sliding.clear();
  joint_impulses.setZero();
}

ContactStepping::ContactStepping(const Dynamics& dynamics) : dynamics_(dynamics), finder_(dynamics.model()) {
  for (ContactRecord* record : {&record_, &record_before_})
    record->joint_impulses.setZero(dynamics.model().n_rows());
  for (const PartModel& m : dynamics.model().parts())
    resting_gap_ = std::max(resting_gap_, kResting * m.part->size());
}

void ContactStepping::begin_step() {
  std::swap(record_, record_before_);
  record_.clear();
}

void ContactStepping::undo_step() {
  std::swap(record_, record_before_);
}

/// Surfaces of this pair that are nearer than this rest on each other, m.
double ContactStepping::resting_gap(const Contact& contact) const {
  const std::vector<PartModel>& parts = dynamics_.model().parts();
  const double a = parts[at(contact.a.part)].part->size();
  return kResting * (contact.b.part < 0 ? a : std::min(a, parts[at(contact.b.part)].part->size()));
}

/// Contacts at the start of a step that neither open nor rebound.
std::vector<Contact> ContactStepping::resting_at(const State& state, double t, double slow) {
  if (last_q_.size() != state.q.size() || last_q_ != state.q || last_t_ != t)
    last_ = finder_.find(state, t, resting_gap_);
  std::vector<Contact> resting = last_;
  resting.erase(std::remove_if(resting.begin(), resting.end(),
                               [&](const Contact& c) {
                                 const double u = finder_.velocity(state, c).dot(c.normal);
                                 return c.gap > resting_gap(c) ||
                                        (c.gap >= -resting_gap(c) && (u > slow || -c.restitution * u > slow));
                               }),
                resting.end());
  return resting;
}

void ContactStepping::step(Integrator& method, State& state, Workspace<double>& work,
                           StepCounters& counters) {
  const double start = state.start, h = state.h, end = state.time() + h;
  const std::int64_t number = state.step;
  const double near = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(end), h);
  const double slow = kSlow * dynamics_.model().body().gravity.norm() * h;
  const double reach = method.reach();
  int events = 0;
  for (double now = state.time(); now < end - near;) {
    const ContactFinder::Neighbourhood around = finder_.neighbourhood(state, now, end - now);
    if (!(around.h > (end - now) / kMostParts)) {
      std::ostringstream message;
      message << "parts move so fast past each other that a step of " << h << " s would be " << kMostParts
              << " and more; a smaller step than " << h << " s may cure it";
      throw NumericalFailure(message.str(), now);
    }
    const double length = around.h >= end - now - near ? end - now : around.h;
    if (now != start + static_cast<double>(number) * h || length != h) set_step(state, now, length);
    if (around.empty) {
      method.step(dynamics_, state, work, counters);
      now += length;
      continue;
    }
    const State before = state;
    method.step(dynamics_, state, work, counters);
    if (!state.q.allFinite() || !state.v.allFinite()) break;
    const double after = now + length;
    const std::vector<Contact> resting = resting_at(before, now, slow);
    // Those that meet at the end, and of those that rested on each other all that are near: rounding may have
    // parted them.
    std::vector<Contact> contacts = finder_.find(state, after, resting.empty() ? 0 : resting_gap_);
    contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                  [&](const Contact& c) {
                                    return c.gap > 0 && (c.gap > resting_gap(c) || !has_pair(resting, c));
                                  }),
                   contacts.end());
    std::vector<Contact> impacts;
    for (Contact& contact : contacts) {
      const double size = dynamics_.model().parts()[at(contact.a.part)].part->size();
      for (const Contact& other : resting)
        if (same_pair(contact, other) &&
            (contact.gap > 0 || (contact.x - other.x).norm() <= kSamePoint * size))
          contact.restitution = 0;
      if (!has_pair(resting, contact) && !has_pair(impacts, contact)) impacts.push_back(contact);
    }
    if (!impacts.empty() && impacts.size() <= kMostPairs && events < kMostEvents) {
      const std::optional<double> tau = locate(method, before, now, length, impacts, state, work, counters);
      if (tau) {
        ++events;
        ++counters.impacts;
        now += *tau;
        // What rests has fallen freely until then as what is in flight has: it is held first.
        std::vector<Contact> lying = finder_.find(state, now, resting_gap_);
        lying.erase(
            std::remove_if(lying.begin(), lying.end(),
                           [&](const Contact& c) { return c.gap > resting_gap(c) || !has_pair(resting, c); }),
            lying.end());
        for (Contact& contact : lying) contact.restitution = 0;
        if (!lying.empty()) settle(reach, *tau, slow, state, now, std::move(lying), work, counters);
        std::vector<Contact> there = finder_.find(state, now, resting_gap_);
        there.erase(std::remove_if(there.begin(), there.end(),
                                   [&](const Contact& c) {
                                     return c.gap > resting_gap(c) ||
                                            (c.gap > kResting * resting_gap(c) && !has_pair(resting, c) &&
                                             !has_pair(impacts, c));
                                   }),
                    there.end());
        for (Contact& contact : there)
          if (has_pair(resting, contact)) contact.restitution = 0;
        settle(0, 0, slow, state, now, std::move(there), work, counters);
        continue;
      }
    }
    if (!contacts.empty()) settle(reach, length, slow, state, after, std::move(contacts), work, counters);
    now = after;
  }
  state.start = start;
  state.step = number;
  state.h = h;
}

/// The time into the step from `before` at which the first of the impacts happens; the state is that of then.
/// None when they were not apart before.
std::optional<double> ContactStepping::locate(Integrator& method, const State& before, double t, double h,
                                              const std::vector<Contact>& impacts, State& state,
                                              Workspace<double>& work, StepCounters& counters) const {
  double size = std::numeric_limits<double>::infinity(), largest = 0;
  for (const Contact& contact : impacts) {
    size = std::min(size, dynamics_.model().parts()[at(contact.a.part)].part->size());
    largest = std::max(largest, dynamics_.model().parts()[at(contact.a.part)].part->size());
  }
  double reached = h;  // how far into the step the state is
  auto go_to = [&](double tau) {
    if (tau == reached) return;
    state = before;
    set_step(state, t, tau);
    method.step(dynamics_, state, work, counters);
    reached = tau;
  };
  auto gap_at = [&](double tau) {
    go_to(tau);
    double least = std::numeric_limits<double>::infinity();
    for (const Contact& contact : impacts)
      least = std::min(least, finder_.least_gap(state, t + tau, contact, 4 * largest));
    return least;
  };
  double high = h, f_high = gap_at(h), low = h, f_low = f_high;
  for (int i = 0; i < kMostTrials && !(f_low > 0); ++i) {  // they were apart after some part of the step
    low *= 0.5;
    f_low = gap_at(low);
    if (!(f_low > 0)) {
      high = low;
      f_high = f_low;
    }
  }
  if (!(f_low > 0)) {
    go_to(h);
    return std::nullopt;
  }
  int side = 0;
  double tau = high;
  for (int i = 0; i < kMostTrials && high - low > kTime * h && !(std::abs(f_high) <= kGap * size); ++i) {
    tau = low + f_low * (high - low) / (f_low - f_high);
    if (!(tau > low && tau < high)) tau = 0.5 * (low + high);
    const double f = gap_at(tau);
    if (f > 0) {
      low = tau;
      f_low = f;
      if (side > 0) f_high *= 0.5;
      side = 1;
    } else {
      high = tau;
      f_high = f;
      if (side < 0) f_low *= 0.5;
      side = -1;
    }
  }
  go_to(high);
  return high;
}

void ContactStepping::evaluate(const State& state, double t, const std::vector<Contact>& contacts,
                               Workspace<double>& work) const {
  std::set<int> alone, islands;
  for (const Contact& contact : contacts)
    for (const int part : {contact.a.part, contact.b.part}) {
      if (part < 0 || dynamics_.model().parts()[at(part)].q0 < 0) continue;
      const int island = dynamics_.model().parts()[at(part)].island;
      if (island < 0)
        alone.insert(part);
      else
        islands.insert(island);
    }
  dynamics_.evaluate_masses(state.q, state.v, std::vector<int>(alone.begin(), alone.end()), work);
  for (const int i : islands)
    dynamics_.factor_joints(t, state.q, state.v, state.joints, dynamics_.model().islands()[at(i)], work);
}

void ContactStepping::move(const std::vector<Mover>& movers, const Workspace<double>& work, double scale,
                           bool as_velocity, State& state) const {
  auto each = [&](const Mover& mover, int part, int first) {
    const PartModel& m = dynamics_.model().parts()[at(part)];
    const PartWorkspace<double>& w = work.parts[at(part)];
    const int n = m.n_x();
    if (as_velocity)
      give_velocity(m, w, mover.x.segment(first, n), state.v);
    else
      advance_with(m, w, mover.x.segment(first, n) - mover.before.segment(first, n), scale, state.q);
  };
  for (const Mover& mover : movers) {
    if (mover.island == nullptr) {
      each(mover, mover.part, 0);
      continue;
    }
    for (std::size_t i = 0; i < mover.island->parts.size(); ++i)
      each(mover, mover.island->parts[i], mover.island->first[i]);
  }
}

/// Impulses at contacts at the end of a step of h seconds, which move what they push by reach h times the
/// change of velocity; then what still overlaps is parted.
void ContactStepping::settle(double reach, double h, double slowest_rebound, State& state, double t,
                             std::vector<Contact> contacts, Workspace<double>& work, StepCounters& counters) {
  const Model& model = dynamics_.model();
  evaluate(state, t, contacts, work);
  std::set<int> touched;
  for (const Contact& contact : contacts)
    for (const int part : {contact.a.part, contact.b.part}) {
      if (part < 0 || model.parts()[at(part)].q0 < 0) continue;
      const int island = model.parts()[at(part)].island;
      if (island < 0)
        touched.insert(part);
      else
        touched.insert(model.islands()[at(island)].parts.begin(), model.islands()[at(island)].parts.end());
    }
  const std::vector<int> parts(touched.begin(), touched.end());
  Workspace<double> scratch;
  const double energy = dynamics_.energy(t, state.q, state.v, parts, scratch);
  const double booked = state.work.sum();  // limits and joints have works of their own

  double most = 0;
  for (const Contact& contact : contacts)
    most = std::max(most, kPartingSpeed * h * model.parts()[at(contact.a.part)].part->size() +
                              h * std::max(0.0, -finder_.velocity(state, contact).dot(contact.normal)));
  ContactProblem problem(model, state, work, contacts);
  const ContactSolution solution = problem.solve(slowest_rebound);
  counters.contact_sweeps += solution.sweeps;
  counters.contact_residual = std::max(counters.contact_residual, solution.residual);
  move(problem.movers(), work, 0, true, state);
  if (reach * h > 0) {
    move(problem.movers(), work, reach * h, false, state);
    double left = most;
    for (int i = 0; i < kMostPartings; ++i) {
      if (!model.joints().empty()) settle_joints(dynamics_, t, state, work, counters);
      last_ = finder_.find(state, t, resting_gap_);
      last_q_ = state.q;
      last_t_ = t;
      std::vector<Contact> deep = last_;
      deep.erase(std::remove_if(deep.begin(), deep.end(), [](const Contact& c) { return c.gap > 0; }),
                 deep.end());
      double deepest = 0;
      for (const Contact& contact : deep) deepest = std::min(deepest, contact.gap);
      if (!(deepest < -kRounding * resting_gap_) || left <= 0) break;
      evaluate(state, t, deep, work);
      ContactProblem parting(model, state, work, deep);
      parting.part_bodies(left);
      left -= std::min(left, -deepest);
      move(parting.movers(), work, 1, false, state);
    }
  }
  settle_limits(dynamics_, t, state, work, counters);
  record_.contacts.insert(record_.contacts.end(), contacts.begin(), contacts.end());
  record_.impulses.insert(record_.impulses.end(), solution.impulse.begin(), solution.impulse.end());
  record_.sliding.insert(record_.sliding.end(), solution.sliding.begin(), solution.sliding.end());
  problem.add_joint_impulses(record_.joint_impulses);
  const double change =
      dynamics_.energy(t, state.q, state.v, parts, scratch) - energy - (state.work.sum() - booked);
  state.work[static_cast<int>(Work::friction)] += solution.friction_work;
  state.work[static_cast<int>(Work::contact)] += change - solution.friction_work;
}

}  // namespace pliant
