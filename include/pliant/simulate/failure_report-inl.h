// Function bodies of failure_report.h.
#pragma once

#include <pliant/simulate/failure_report.h>

#include <cmath>
#include <sstream>

#include <pliant/math/finite.h>
#include <pliant/math/header_only.h>

namespace pliant::failure_report {

/// A part has burst if a node is displaced by more than this multiple of the size of the part.
inline constexpr double kBurst = 2;

PLIANT_INLINE std::string burst_parts(const Model& model, const State& state) {
  std::ostringstream message;
  for (const PartModel& m : model.parts()) {
    if (m.local == nullptr) continue;
    const Nodes d = m.local->displacements(state.q.data() + m.q0 + 7 + m.n_s);
    const double farthest = d.rowwise().norm().maxCoeff() / m.part->size();
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

PLIANT_INLINE std::string not_finite(const Model& model, const State& state, const Workspace<double>& work) {
  const std::string gap = gap_not_finite(model, work);
  if (!gap.empty()) return gap;
  if (all_finite(state.q) && all_finite(state.v) && all_finite(state.work)) return {};
  for (Eigen::Index i = 0; i < state.v.size(); ++i)
    if (!std::isfinite(state.v[i])) return model.velocity_name(static_cast<int>(i));
  for (Eigen::Index i = 0; i < state.q.size(); ++i)
    if (!std::isfinite(state.q[i])) return model.coordinate_name(static_cast<int>(i));
  return "the work of the ledger";
}

PLIANT_INLINE std::string cause(const Dynamics& dynamics, const State& before) {
  Workspace<double> scratch;
  std::string term = dynamics.diagnose(before.time(), before.q, before.v, before, scratch);
  if (term.empty()) term = dynamics.diagnose(before.time() + before.h, before.q, before.v, before, scratch);
  if (!term.empty()) return "the first term that is not finite is " + term;
  std::ostringstream message;
  message << "the motion has grown without bound; use a smaller step than " << before.h << " s";
  return message.str();
}

}  // namespace pliant::failure_report
