// Function bodies of contact_stepping.h: steps of implicit methods in which parts that deform locally may
// touch something. Such a step is repeated as two halves, and both results are extrapolated where that is
// possible.
#pragma once

#include <pliant/contact/contact_stepping.h>

#include <algorithm>
#include <cmath>

#include <pliant/body/step_failure.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace soft_contact {

/// Contacts at nodes may overlap by this multiple of RestingContacts::tight_gap after extrapolation. Nodes
/// that would be deeper keep the positions of the halves.
inline constexpr double kMaxOverlap = 400;
/// If a contact at nodes is deeper than this multiple of RestingContacts::tight_gap at the start of a step,
/// the step separates bodies, and is not repeated. The multiple is larger than that which a separation leaves
/// (contact_separation::kMeshOverlap).
inline constexpr double kMaxOverlapAtStart = 1000;
/// Largest number of rounds of the search for nodes that keep the positions of the halves. If more rounds are
/// needed, the result of the halves is used.
inline constexpr int kMaxRounds = 3;

/// Returns the share s of the extrapolation, from 0 to 1, with which a step adds no energy. The balance of a
/// result is its change of energy minus its works. If energies are quadratic, the balance with the share s is
///   b(s) = halves + s (halves - whole) + s (1 + s) / 2 excess.
/// halves, whole: balances of both results, J; negative if they lose energy. extrapolated: b(1), J; it
/// determines the constant `excess`.
inline double share_without_gain(double halves, double whole, double extrapolated) {
  if (!(extrapolated > 0)) return 1;
  if (!(halves < 0)) return extrapolated <= halves ? 1 : 0;
  const double half_excess = 0.5 * (extrapolated - 2 * halves + whole), slope = halves - whole + half_excess;
  if (!(half_excess > 0)) return std::clamp(-halves / slope, 0.0, 1.0);
  return std::clamp((std::sqrt(slope * slope - 4 * half_excess * halves) - slope) / (2 * half_excess), 0.0,
                    1.0);
}

/// A step is extrapolated if both results differ in the position of each part by at most this share of its
/// size: larger differences are those of impacts, and not of a smooth motion.
inline constexpr double kMaxDifference = 0.05;

/// Returns whether two states differ in the position of one of the parts by more than kMaxDifference.
inline bool differ(const Model& model, const State& a, const State& b, const std::vector<int>& parts) {
  return std::any_of(parts.begin(), parts.end(), [&](int i) {
    const PartModel& m = model.parts()[at(i)];
    return (a.q.segment<3>(m.q0) - b.q.segment<3>(m.q0)).norm() > kMaxDifference * m.size;
  });
}

/// Copies the positions of the nodes of one side of a contact. If the part has modes in place of nodes, all
/// its coordinates and velocities are copied.
inline void copy_nodes(const Model& model, const ContactSide& side, const State& from, State& to) {
  if (side.part < 0 || !side.at_nodes()) return;
  const PartModel& m = model.parts()[at(side.part)];
  if (m.q0 < 0) return;
  if (m.local == nullptr || m.local->nodal() == nullptr) {
    to.q.segment(m.q0, m.n_q()) = from.q.segment(m.q0, m.n_q());
    to.v.segment(m.v0, m.n_v()) = from.v.segment(m.v0, m.n_v());
    return;
  }
  const auto n_nodes = static_cast<int>(m.local->mesh().X.rows());
  for (const int node : side.node)
    for (int axis = 0; node >= 0 && axis < 3; ++axis) {
      const int k = m.q0 + 7 + m.n_s + axis * n_nodes + node;
      to.q[k] = from.q[k];
    }
}

}  // namespace soft_contact

/// Repeats a step with parts that deform locally as two halves, and extrapolates from both (Richardson). With
/// linearly_implicit, such a step is one of linearly implicit Euler, which damps an oscillation with the
/// frequency omega by a rate of omega^2 h / 2. The extrapolation has second order, and damps by a rate of
/// order h^3. Nodes that the extrapolation would move into a body keep the positions of the halves. If rigid
/// contacts, sleeping parts, or modes of limits or joints differ, the result of the halves is used. If the
/// halves fail, the result of the whole step is used.
PLIANT_INLINE void ContactStepping::extrapolate_soft_step(Integrator& method, StepContext& step,
                                                          const Before& before, double length,
                                                          double tolerance) {
  const Model& model = dynamics_.model();
  State& state = step.state;
  const auto rigid_contacts = [&](std::size_t from, std::size_t to) {
    return std::count_if(record_.contacts.begin() + static_cast<std::ptrdiff_t>(from),
                         record_.contacts.begin() + static_cast<std::ptrdiff_t>(to),
                         [](const Contact& c) { return !c.a.at_nodes() && !c.b.at_nodes(); });
  };
  const std::size_t first = before.record.contacts.size();
  const auto rigid = rigid_contacts(first, record_.contacts.size());
  const Whole whole{state, length, resting_at_start_, record_.contacts.size() - first, false};
  const ContactRecord record = record_;
  const double recorded = recorded_;
  state = before.state;
  record_ = before.record;
  recorded_ = before.recorded;
  step.counters.impacts = before.counters.impacts;
  step.counters.sequential_impacts = before.counters.sequential_impacts;
  Fractions halves;
  try {
    halves = step_fractions(2, method, step, whole, before.state, tolerance);
  } catch (const StepFailure&) {
    halves.finite = false;
  }
  if (!halves.finite || halves.length != length) {
    state = whole.state;
    record_ = record;
    recorded_ = recorded;
    return;
  }
  if (state.at_limit != whole.state.at_limit || state.joints != whole.state.joints ||
      !same_sleepers(state.at_rest, whole.state.at_rest) ||
      rigid_contacts(halves.last_contacts, record_.contacts.size()) != rigid)
    return;
  std::vector<int> parts;
  for (std::size_t i = 0; i < model.parts().size(); ++i)
    if (model.parts()[i].q0 >= 0 && !(state.at_rest.size() > i && state.at_rest[i] < 0))
      parts.push_back(static_cast<int>(i));
  StepContext at_end(dynamics_, state, step.work, step.counters, before.state.time() + length, length);
  extrapolate(at_end, {soft_extrapolation(at_end.t, before.state, state, whole.state, parts)},
              halves.last_contacts, parts);
}

/// Returns whether a state has a contact at nodes that is deeper than soft_contact::kMaxOverlapAtStart.
PLIANT_INLINE bool ContactStepping::has_deep_nodes(const State& state) {
  std::vector<Contact> found;
  meshes_.find(state, state.time(), found);
  return std::any_of(found.begin(), found.end(), [&](const Contact& contact) {
    return -contact.gap > soft_contact::kMaxOverlapAtStart * resting_.tight_gap(contact);
  });
}

/// Finds the nodes that are deeper in a body than soft_contact::kMaxOverlap at the state `full` and the time
/// t (s), and copies their positions from `halves` to `coarse`. Returns whether there are such nodes.
PLIANT_INLINE bool ContactStepping::copy_deep_nodes(double t, const State& full, const State& halves,
                                                    State& coarse) {
  std::vector<Contact> found;
  meshes_.find(full, t, found);
  bool any = false;
  for (const Contact& contact : found) {
    if (-contact.gap <= soft_contact::kMaxOverlap * resting_.tight_gap(contact)) continue;
    any = true;
    for (const ContactSide* side : {&contact.a, &contact.b})
      soft_contact::copy_nodes(dynamics_.model(), *side, halves, coarse);
  }
  return any;
}

/// Chooses the coarse state and the share of the extrapolation of a soft contact step. A node that
/// extrapolation would move into a body keeps the position of the halves, because it met the body in only one
/// of both results. The share is below 1 where extrapolation would add energy. start, halves, whole: states
/// at the start of the step, and at its end after the two halves and after the whole step.
PLIANT_INLINE ContactStepping::Coarse ContactStepping::soft_extrapolation(double t, const State& start,
                                                                          const State& halves,
                                                                          const State& whole,
                                                                          const std::vector<int>& parts) {
  const Model& model = dynamics_.model();
  if (soft_contact::differ(model, halves, whole, parts)) return {whole, 0, whole};
  Coarse result{whole, 1, whole};
  State full = extrapolated(halves, {result}, parts);
  for (int round = 0; copy_deep_nodes(t, full, halves, result.state); ++round) {
    if (round == soft_contact::kMaxRounds) return {whole, 0, whole};
    full = extrapolated(halves, {result}, parts);
  }
  auto energy_of = [&](const State& state) { return dynamics_.energy(t, state.q, state.v, parts, scratch_); };
  const double before = energy_of(start) - start.work.sum(),
               of_halves = energy_of(halves) - halves.work.sum() - before,
               of_coarse = energy_of(result.state) - whole.work.sum() - before,
               balance = energy_of(full) - (2 * halves.work.sum() - whole.work.sum()) - before;
  result.share = soft_contact::share_without_gain(of_halves, of_coarse, balance);
  return result;
}

}  // namespace pliant
