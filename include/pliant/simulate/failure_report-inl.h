// Function bodies of failure_report.h.
#pragma once

#include <pliant/simulate/failure_report.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include <pliant/math/finite.h>
#include <pliant/math/header_only.h>

namespace pliant::failure_report {

/// A part has burst if a node is displaced by more than this multiple of the size of the part.
inline constexpr double kBurst = 2;
/// The square of the norm of a quaternion may differ from 1 by at most kUnit. Coordinates and velocities
/// above kLargest are reported as not finite, because the energies contain their squares.
inline constexpr double kUnit = 1e-6, kLargest = 1e150;

PLIANT_INLINE std::string burst_parts(const Model& model, const State& state) {
  std::ostringstream message;
  for (const PartModel& m : model.parts()) {
    if (m.local == nullptr) continue;
    const Nodes d = m.local->displacements(state.q.data() + m.q0 + 7 + m.n_s);
    const double farthest = d.rowwise().norm().maxCoeff() / m.size;
    if (!(farthest > kBurst)) continue;
    message << "part '" << m.part->name() << "' has burst: its nodes are up to " << farthest
            << " times its size away from rest, because its elasticity does not balance its load (use a "
               "smaller load or a stiffer law) or because the steps are too long for it; ";
  }
  return message.str();
}

/// Returns a text that names the first joint whose gap is not finite; empty if there is none. Joints of rigid
/// islands (body/constraint/rigid_island.h) are ignored, because their gaps are not evaluated.
inline std::string gap_not_finite(const Model& model, const Workspace<double>& work) {
  if (work.joints.C.allFinite()) return {};
  for (const JointModel& joint : model.joints()) {
    const int rigid = model.islands()[static_cast<std::size_t>(joint.island)].rigid;
    const bool evaluated = rigid < 0 || !work.rigid[static_cast<std::size_t>(rigid)].used;
    if (evaluated && !work.joints.C.segment(joint.row, joint.rows).allFinite())
      return "the gap of joint '" + joint.joint->name() + "'";
  }
  return {};
}

/// Returns the name of the part whose quaternion is not a rotation; empty if there is none.
inline std::string part_without_orientation(const Model& model, const State& state) {
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0 && !(std::abs(state.q.segment<4>(m.q0 + 3).squaredNorm() - 1) <= kUnit))
      return m.part->name();
  return {};
}

PLIANT_INLINE std::string fault_of(const Model& model, const State& state, const Workspace<double>& work) {
  const char* not_finite = " is not a finite number";
  const std::string gap = gap_not_finite(model, work);
  if (!gap.empty()) return gap + not_finite;
  if (!(std::isfinite(state.q.squaredNorm()) && std::isfinite(state.v.squaredNorm()) &&
        all_finite(state.work))) {
    for (Eigen::Index i = 0; i < state.v.size(); ++i)
      if (!(std::abs(state.v[i]) <= kLargest)) return model.velocity_name(static_cast<int>(i)) + not_finite;
    for (Eigen::Index i = 0; i < state.q.size(); ++i)
      if (!(std::abs(state.q[i]) <= kLargest)) return model.coordinate_name(static_cast<int>(i)) + not_finite;
    for (int k = 0; k < kWorks; ++k)
      if (!std::isfinite(state.work[k]))
        return std::string("the work of ") + kWorkNames[static_cast<std::size_t>(k)] + not_finite;
    return "the sum of the squares of the coordinates or of the velocities is too large";
  }
  const std::string part = part_without_orientation(model, state);
  if (part.empty()) return {};
  return "the quaternion of part '" + part + "' is no longer a rotation";
}

/// A change of energy, J, and a text that names the energy.
struct EnergyChange {
  double change = 0;
  std::string of;

  void keep_larger(double other, const std::string& name) {
    if (!of.empty() && std::abs(other) <= std::abs(change)) return;
    change = std::isfinite(other) ? other : std::numeric_limits<double>::infinity();
    of = name;
  }
  std::string text() const {
    std::ostringstream message;
    message.precision(4);
    message << of << " by ";
    if (std::isfinite(change))
      message << change << " J";
    else
      message << "more than any number";
    return message.str();
  }
};

PLIANT_INLINE std::string largest_energy_change(const Dynamics& dynamics, const State& before,
                                                const State& after) {
  const Model& model = dynamics.model();
  Workspace<double> work;
  EnergyChange energy, done;
  for (int k = 0; k < kWorks; ++k)
    done.keep_larger(after.work[k] - before.work[k],
                     std::string("the work of ") + kWorkNames[static_cast<std::size_t>(k)]);
  for (int i = 0; i < static_cast<int>(model.parts().size()); ++i) {
    const PartModel& m = model.parts()[static_cast<std::size_t>(i)];
    if (m.q0 < 0) continue;
    auto energies = [&](const State& state) {
      const VecX<double> at_rest = VecX<double>::Zero(state.v.size());
      const double potential = dynamics.energy(state.time(), state.q, at_rest, {i}, work);
      return std::make_pair(potential,
                            dynamics.energy(state.time(), state.q, state.v, {i}, work) - potential);
    };
    const auto [potential, kinetic] = energies(before);
    const auto [potential_after, kinetic_after] = energies(after);
    const std::string of_part = " energy of part '" + m.part->name() + "'";
    energy.keep_larger(potential_after - potential, "the potential" + of_part);
    energy.keep_larger(kinetic_after - kinetic, "the kinetic" + of_part);
  }
  if (energy.of.empty()) return "no part moves";
  std::ostringstream message;
  message << "since t = " << before.time() << " s the largest changes are those of " << energy.text();
  if (done.change != 0) message << ", and of " << done.text();
  return message.str();
}

PLIANT_INLINE std::string place(double t, double h) {
  std::ostringstream message;
  message << "at t = " << t << " s, in a step of " << h << " s: ";
  return message.str();
}

/// Returns a text that names the part with the largest velocity of any coordinate.
inline std::string fastest_part(const Model& model, const State& state) {
  const PartModel* fastest = nullptr;
  double largest = 0;
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    const double rate = state.v.segment(m.v0, m.n_v()).lpNorm<Eigen::Infinity>();
    if (rate <= largest) continue;
    largest = rate;
    fastest = &m;
  }
  if (fastest == nullptr) return {};
  std::ostringstream message;
  message << "; part '" << fastest->part->name() << "' is fastest before the step, with " << largest
          << " m/s or rad/s";
  return message.str();
}

PLIANT_INLINE std::string cause(const Dynamics& dynamics, const State& before) {
  Workspace<double> scratch;
  std::string term = dynamics.diagnose(before.time(), before.q, before.v, before, scratch);
  if (term.empty()) term = dynamics.diagnose(before.time() + before.h, before.q, before.v, before, scratch);
  if (!term.empty()) return "the first term that is not finite is " + term;
  return "the motion has grown without bound" + fastest_part(dynamics.model(), before);
}

}  // namespace pliant::failure_report
