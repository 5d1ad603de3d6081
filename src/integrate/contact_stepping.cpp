#include <pliant/integrate/contact_stepping.h>

#include <algorithm>
#include <array>
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
/// Most pairs whose impacts in one step are told in time, which takes the step of all parts several times
/// again; and most moving parts of a body for which that is worth it.
constexpr std::size_t kMostPairs = 3;
constexpr std::ptrdiff_t kMostLocated = 8;
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
constexpr int kMostPartings = 8;
/// Most times in a step that bodies which impulses throw meet others.
constexpr int kMostLinks = 4;
/// Overlaps below this share of what counts as resting are left; and below this when they have been parted
/// once in a step, as they will be in the next.
constexpr double kRounding = 1e-8, kParted = 0.1;
/// Meshes may overlap by this, in sizes, without being parted.
constexpr double kMeshOverlap = 2e-4;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

bool of_meshes(const Contact& contact) {
  return contact.a.at_nodes() || contact.b.at_nodes();
}

/// Contacts by what touches what.
class Pairs {
 public:
  /// The contacts must outlive it.
  explicit Pairs(const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) all_.emplace_back(key(contact), &contact);
    std::sort(all_.begin(), all_.end());
  }
  bool has(const Contact& contact) const {
    const auto [first, last] = range(contact);
    return first != last;
  }
  /// Whether some contact of the same pair is one that `is` says it is.
  template <class F>
  bool has(const Contact& contact, F&& is) const {
    const auto [first, last] = range(contact);
    return std::any_of(first, last, [&](const Entry& entry) { return is(*entry.second); });
  }

 private:
  using Key = std::array<int, 4>;
  using Entry = std::pair<Key, const Contact*>;
  static Key key(const Contact& contact) {
    return {contact.a.part, contact.b.part, contact.plane, contact.obstacle};
  }
  std::pair<std::vector<Entry>::const_iterator, std::vector<Entry>::const_iterator> range(
      const Contact& contact) const {
    struct Before {
      bool operator()(const Entry& entry, const Key& k) const { return entry.first < k; }
      bool operator()(const Key& k, const Entry& entry) const { return k < entry.first; }
    };
    return std::equal_range(all_.begin(), all_.end(), key(contact), Before{});
  }
  std::vector<Entry> all_;
};

/// act(mover, part, first of its numbers in the mover) for each part of each mover, nodes last.
template <class F>
void for_each_part(const std::vector<Mover>& movers, F&& act) {
  for (const Mover& mover : movers) {
    if (mover.node >= 0) continue;
    if (mover.island == nullptr) {
      act(mover, mover.part, 0);
      continue;
    }
    for (std::size_t i = 0; i < mover.island->parts.size(); ++i)
      act(mover, mover.island->parts[i], mover.island->first[i]);
  }
  for (const Mover& mover : movers)
    if (mover.node >= 0) act(mover, mover.part, 0);
}

/// Adds to the displacements, or rates, of a node.
void move_node(const Model& model, const Mover& mover, const Vec3<double>& d, Eigen::Ref<VecX<double>> q_d) {
  const Eigen::Index n = model.parts()[at(mover.part)].local->mesh().X.rows();
  for (Eigen::Index r = 0; r < 3; ++r) q_d[mover.node + r * n] += d[r];
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

ContactStepping::ContactStepping(const Dynamics& dynamics)
    : dynamics_(dynamics), finder_(dynamics.model()), meshes_(dynamics.model(), finder_.obstacles()) {
  for (ContactRecord* record : {&record_, &record_before_})
    record->joint_impulses.setZero(dynamics.model().n_rows());
  few_parts_ = std::count_if(dynamics.model().parts().begin(), dynamics.model().parts().end(),
                             [](const PartModel& m) { return m.q0 >= 0; }) <= kMostLocated;
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

bool ContactStepping::any_lasts() const {
  return std::any_of(record_.contacts.begin(), record_.contacts.end(),
                     [](const Contact& contact) { return contact.since > 0; });
}

/// Surfaces of this pair that are nearer than this rest on each other, m.
double ContactStepping::resting_gap(const Contact& contact) const {
  const std::vector<PartModel>& parts = dynamics_.model().parts();
  const double a = parts[at(contact.a.part)].part->size();
  return kResting * (contact.b.part < 0 ? a : std::min(a, parts[at(contact.b.part)].part->size()));
}

/// Whether surfaces with this gap between them and this velocity against each other rest there.
bool ContactStepping::rests(const Contact& contact, double gap, double velocity, double slow) const {
  const double near = resting_gap(contact);
  return gap < -near || (gap <= near && std::abs(velocity) <= slow);
}

/// Contacts at the start of a step that neither open nor strike.
std::vector<Contact> ContactStepping::resting_at(const State& state, double t, double slow) {
  std::vector<Contact> resting = near(state, t);
  resting.erase(std::remove_if(resting.begin(), resting.end(),
                               [&](const Contact& c) {
                                 return !rests(c, c.gap, finder_.velocity(state, c).dot(c.normal), slow);
                               }),
                resting.end());
  return resting;
}

/// Whether a contact at the end of a step rested at its start, by how its sides have moved in between: faces
/// that lie on each other may touch at other points of theirs.
bool ContactStepping::rested(const Contact& contact, const State& before, const State& state, double reach,
                             double slow) const {
  const double u_start = finder_.velocity(before, contact).dot(contact.normal),
               u = finder_.velocity(state, contact).dot(contact.normal);
  return rests(contact, contact.gap - state.h * ((1 - reach) * u_start + reach * u), u_start, slow);
}

double ContactStepping::step(Integrator& method, State& state, Workspace<double>& work,
                             StepCounters& counters, bool to_impact) {
  const double start = state.start, h = state.h, begin = state.time(), end = begin + h;
  double taken = h;
  const std::int64_t number = state.step;
  const double near = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(end), h);
  const double slow = kSlow * dynamics_.model().body().gravity_at(end).norm() * h;
  const double reach = method.reach();
  int events = 0;
  for (double now = state.time(); now < end - near;) {
    ContactFinder::Neighbourhood around = finder_.neighbourhood(state, now, end - now);
    if (!meshes_.empty()) meshes_.approach(state, now, end - now, around);
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
    const Pairs rest(resting);
    // Those that meet at the end, and of those that rested on each other all that are near: rounding may have
    // parted them.
    std::vector<Contact> contacts = finder_.find(state, after, resting.empty() ? 0 : resting_gap_);
    contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                  [&](const Contact& c) {
                                    return c.gap > 0 && (c.gap > resting_gap(c) || !rest.has(c));
                                  }),
                   contacts.end());
    std::vector<Contact> impacts;
    for (Contact& contact : contacts) {
      const double size = dynamics_.model().parts()[at(contact.a.part)].part->size();
      if (rest.has(contact,
                   [&](const Contact& other) {
                     return contact.gap > 0 || (contact.x - other.x).norm() <= kSamePoint * size;
                   }) ||
          (rest.has(contact) && rested(contact, before, state, reach, slow)))
        contact.since = reach * length;
      if (impacts.size() <= kMostPairs && few_parts_ && !rest.has(contact) && !Pairs(impacts).has(contact))
        impacts.push_back(contact);
    }
    if (!impacts.empty() && impacts.size() <= kMostPairs && events < kMostEvents) {
      const std::optional<double> tau = locate(method, before, now, length, impacts, state, work, counters);
      if (tau) {
        ++events;
        ++counters.impacts;
        now += *tau;
        // What rests has fallen freely until then as what is in flight has: it is held first.
        std::vector<Contact> lying = finder_.find(state, now, resting_gap_);
        lying.erase(std::remove_if(lying.begin(), lying.end(),
                                   [&](const Contact& c) { return c.gap > resting_gap(c) || !rest.has(c); }),
                    lying.end());
        for (Contact& contact : lying) contact.since = reach * *tau;
        meshes_.find(state, now, lying);
        time_impacts(before, state, reach, *tau, slow, lying);
        settle(before, reach * *tau, *tau, state, now, std::move(lying), work, counters);
        std::vector<Contact> there = finder_.find(state, now, resting_gap_);
        there.erase(std::remove_if(there.begin(), there.end(),
                                   [&](const Contact& c) {
                                     return c.gap > resting_gap(c) ||
                                            (c.gap > kResting * resting_gap(c) && !rest.has(c) &&
                                             !Pairs(impacts).has(c));
                                   }),
                    there.end());
        for (Contact& contact : there) {
          const double rebound = -contact.restitution * finder_.velocity(state, contact).dot(contact.normal);
          if (!rest.has(contact) && rebound > slow) contact.rebound = rebound;
        }
        settle(state, 0, 0, state, now, std::move(there), work, counters);
        if (!to_impact || !(now > begin)) continue;
        taken = now - begin;
        break;
      }
    }
    meshes_.find(state, after, contacts);
    time_impacts(before, state, reach, length, slow, contacts);
    settle(before, reach * length, length, state, after, contacts, work, counters);
    settle_chain(std::move(contacts), length, slow, state, after, work, counters);
    now = after;
  }
  state.start = start;
  state.step = number;
  state.h = h;
  return taken;
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

/// How long ago each contact of a step of h seconds began, were its sides to meet at the speed they have now,
/// and the velocity it leaves them with. Those that have a `since` rest.
void ContactStepping::time_impacts(const State& before, const State& state, double reach, double h,
                                   double slow, std::vector<Contact>& contacts) const {
  for (Contact& contact : contacts) {
    if (contact.since > 0) continue;
    const double u = finder_.velocity(state, contact).dot(contact.normal);
    contact.since = u < 0 && contact.gap < 0 ? std::min(h, contact.gap / u) : reach * h;
    const double u_start = finder_.velocity(before, contact).dot(contact.normal);
    if (!(u < 0 && contact.gap < 0 && u_start < -slow)) continue;
    // What pushes the sides together has done so since then too.
    const double gained = (u - u_start) / h * contact.since, approach = gained - u;
    if (contact.restitution * approach > slow)
      contact.rebound = std::max(0.0, contact.restitution * approach + gained);
  }
}

/// Parts that move and are touched, with those that joints tie to them.
std::vector<int> ContactStepping::parts_touched(const std::vector<Contact>& contacts) const {
  const Model& model = dynamics_.model();
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
  return std::vector<int>(touched.begin(), touched.end());
}

/// Whether hands move joints of some parts.
bool ContactStepping::driven(const std::vector<int>& parts) const {
  const Model& model = dynamics_.model();
  return std::any_of(parts.begin(), parts.end(), [&](int part) {
    const int island = model.parts()[at(part)].island;
    if (island < 0) return false;
    const std::vector<int>& joints = model.islands()[at(island)].joints;
    return std::any_of(joints.begin(), joints.end(), [&](int j) { return model.joints()[at(j)].driven; });
  });
}

/// What the contact problem needs: masses of the parts that it does not move node by node.
void ContactStepping::evaluate(const State& state, double t, const std::vector<Contact>& contacts,
                               Workspace<double>& work) const {
  std::set<int> alone, islands;
  for (const Contact& contact : contacts)
    for (const ContactSide& side : {contact.a, contact.b}) {
      if (side.part < 0 || side.at_nodes() || dynamics_.model().parts()[at(side.part)].q0 < 0) continue;
      const int island = dynamics_.model().parts()[at(side.part)].island;
      if (island < 0)
        alone.insert(side.part);
      else
        islands.insert(island);
    }
  dynamics_.evaluate_masses(state.q, state.v, std::vector<int>(alone.begin(), alone.end()), work);
  for (const int i : islands)
    dynamics_.factor_joints(t, state.q, state.v, state.joints, dynamics_.model().islands()[at(i)], work);
}

/// The velocities that impulses gave, and the ways they went since.
void ContactStepping::move(const ContactProblem& problem, const Workspace<double>& work, State& state) const {
  for_each_part(problem.movers(), [&](const Mover& mover, int part, int first) {
    const PartModel& m = dynamics_.model().parts()[at(part)];
    if (mover.node < 0) {
      give_velocity(m, work.parts[at(part)], problem.after(mover).segment(first, m.n_x()), state.v);
      return advance_with(m, work.parts[at(part)], problem.shift(mover).segment(first, m.n_x()), 1, state.q);
    }
    const Eigen::Quaterniond to_body = dynamics_.model().orientation(state, part).conjugate();
    const Vec3<double> shift = to_body * problem.shift(mover).head<3>(),
                       change = to_body * (problem.after(mover) - problem.before(mover)).head<3>(),
                       omega = state.v.segment<3>(m.v0 + 3);
    move_node(dynamics_.model(), mover, shift, state.q.segment(m.q0 + 7 + m.n_s, m.n_d()));
    // Its velocity is omega x p + d_dot, and p has moved.
    move_node(dynamics_.model(), mover, change - omega.cross(shift),
              state.v.segment(m.v0 + 6 + m.n_s, m.n_d()));
  });
}

/// After velocities and places of what contacts push have changed: frames follow the nodes, joints hold.
void ContactStepping::reconcile(const std::vector<int>& parts, State& state, double t,
                                Workspace<double>& work, StepCounters& counters) const {
  settle_frames(dynamics_, t, parts, state, work);
  settle_joints(dynamics_, t, state, work, counters);
}

/// Impulses at contacts at the end of a step of h seconds from a state before, each as long ago as it says;
/// then what still overlaps is parted.
void ContactStepping::settle(const State& before, double since_of_limits, double h, State& state, double t,
                             std::vector<Contact> contacts, Workspace<double>& work, StepCounters& counters) {
  if (contacts.empty()) return;
  const std::vector<int> parts = parts_touched(contacts);
  const double booked = state.work.sum();
  evaluate(state, t, contacts, work);
  double most = 0, thrown = 0;  // that they are parted by; that impulses move their sides
  std::vector<double> opening;
  for (const Contact& contact : contacts) {
    opening.push_back(finder_.velocity(state, contact).dot(contact.normal));
    most = std::max(most, kPartingSpeed * h * dynamics_.model().parts()[at(contact.a.part)].part->size() +
                              h * std::max(0.0, -opening.back()));
  }
  ContactProblem problem(dynamics_.model(), state, work, contacts);
  const std::vector<Vec3<double>> u_start = problem.velocities(before);
  const ContactSolution solution = problem.solve(since_of_limits);
  counters.contact_sweeps += solution.sweeps;
  counters.contact_fallbacks += solution.fallbacks;
  counters.contact_residual = std::max(counters.contact_residual, solution.residual);
  bool smooth = false, deep = false;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    const Vec3<double> mean = 0.5 * (u_start[k] + solution.velocity[k]), p = solution.impulse[k];
    const double along = mean.dot(c.normal), p_n = p.dot(c.normal);
    state.work[static_cast<int>(Work::friction)] += p.dot(mean) - p_n * along;
    state.work[static_cast<int>(Work::contact)] += p_n * along + p.dot(c.carried);
    const double moved = c.since * (solution.velocity[k].dot(c.normal) - opening[k]);
    thrown = std::max(thrown, moved);
    if (!of_meshes(c)) {
      smooth = true;
      continue;
    }
    deep = deep || c.gap + moved < -kMeshOverlap * dynamics_.model().parts()[at(c.a.part)].part->size();
  }
  problem.add_joint_impulses(record_.joint_impulses);
  problem.bound_shifts(since_of_limits, h);
  if (deep) problem.part_bodies(most);
  // The work of an impulse is that of a constant force over the step, to second order; where a limit or a
  // string has stopped something within it too, or bodies are parted, it is what the energy changes by. So is
  // that of hands that move joints, on which impulses push back, and of impulses at one moment.
  const bool hands = driven(parts), moment = &before == &state;
  const bool broken =
      hands || deep || moment || state.at_limit != before.at_limit || state.joints != before.joints;
  Workspace<double> scratch;
  const double energy = broken ? dynamics_.energy(t, state.q, state.v, parts, scratch) : 0;
  move(problem, work, state);
  if (h > 0 || deep) reconcile(parts, state, t, work, counters);
  if (h > 0 && smooth) part_overlaps(most + thrown, state, t, work, counters);
  settle_limits(dynamics_, t, state, work, counters);
  if (broken)
    state.work[static_cast<int>(hands ? Work::anchors : Work::contact)] +=
        dynamics_.energy(t, state.q, state.v, parts, scratch) - energy - (state.work.sum() - booked);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Vec3<double>&u = solution.velocity[k], &n = contacts[k].normal;
    record_.contacts.push_back(contacts[k]);
    record_.impulses.push_back(solution.impulse[k]);
    record_.sliding.push_back((u - u.dot(n) * n).norm());
  }
}

/// What lies near each other, within what counts as resting.
const std::vector<Contact>& ContactStepping::near(const State& state, double t) {
  if (last_q_.size() != state.q.size() || last_q_ != state.q || last_t_ != t) {
    last_ = finder_.find(state, t, resting_gap_);
    last_q_ = state.q;
    last_t_ = t;
  }
  return last_;
}

/// Impulses of a step of h seconds at some contacts throw bodies against others that were out of their way:
/// these impacts are of the same step, and so are those that follow from them.
void ContactStepping::settle_chain(std::vector<Contact> settled, double h, double slow, State& state,
                                   double t, Workspace<double>& work, StepCounters& counters) {
  for (int link = 0; link < kMostLinks && !settled.empty(); ++link) {
    const Pairs known(settled);
    std::vector<Contact> contacts = near(state, t);
    double earliest = 0;  // how long ago, s
    for (Contact& contact : contacts) {
      const double u = finder_.velocity(state, contact).dot(contact.normal);
      if (!(contact.gap < -resting_gap(contact) && u < -slow) ||
          known.has(contact, [&](const Contact& other) { return other.gap <= contact.gap; }))
        continue;
      contact.since = std::min(h, contact.gap / u);
      if (-contact.restitution * u > slow) contact.rebound = -contact.restitution * u;
      earliest = std::max(earliest, contact.since);
    }
    if (earliest == 0) return;
    contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                  [&](const Contact& c) { return c.gap > resting_gap(c); }),
                   contacts.end());
    meshes_.find(state, t, contacts);
    for (Contact& contact : contacts)
      if (contact.since == 0) contact.since = earliest;
    settle(state, 0, h, state, t, contacts, work, counters);
    settled.insert(settled.end(), contacts.begin(), contacts.end());
  }
}

/// Moves smooth bodies that overlap apart, by at most so many m.
void ContactStepping::part_overlaps(double most, State& state, double t, Workspace<double>& work,
                                    StepCounters& counters) {
  double start = 0;  // the deepest at first, m
  for (int i = 0; i < kMostPartings; ++i) {
    std::vector<Contact> deep = near(state, t);
    double deepest = 0;
    for (const Contact& contact : deep) deepest = std::max(deepest, -contact.gap);
    if (i == 0) start = deepest;
    const double left = most - std::max(0.0, start - deepest);
    if (!(deepest > (i == 0 ? kRounding : kParted) * resting_gap_) || !(left > 0)) return;
    // Parted by so much, they may meet what is as near.
    if (deepest > resting_gap_) deep = finder_.find(state, t, std::min(deepest, left));
    const std::vector<int> parts = parts_touched(deep);
    Workspace<double> scratch;
    const double energy = dynamics_.energy(t, state.q, state.v, parts, scratch), booked = state.work.sum();
    evaluate(state, t, deep, work);
    ContactProblem parting(dynamics_.model(), state, work, deep);
    parting.part_bodies(left);
    move(parting, work, state);
    reconcile(parts, state, t, work, counters);
    state.work[static_cast<int>(Work::contact)] +=
        dynamics_.energy(t, state.q, state.v, parts, scratch) - energy - (state.work.sum() - booked);
  }
}

}  // namespace pliant
