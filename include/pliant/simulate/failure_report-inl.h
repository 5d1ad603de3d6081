// Bodies of failure_report.h.
#pragma once

#include <cmath>
#include <sstream>

#include <pliant/math/finite.h>
#include <pliant/math/header_only.h>
#include <pliant/simulate/failure_report.h>

namespace pliant::failure_report {

/// A part has burst when its nodes are this many times its size away from rest.
inline constexpr double kBurst = 2;

PLIANT_INLINE std::string burst_parts(const Model& model, const State& state) {
  std::ostringstream message;
  for (const PartModel& m : model.parts()) {
    if (m.local == nullptr) continue;
    const Nodes d = m.local->displacements(state.q.data() + m.q0 + 7 + m.n_s);
    const double farthest = d.rowwise().norm().maxCoeff() / m.part->size();
    if (!(farthest > kBurst)) continue;
    message << "part '" << m.part->name() << "' has burst: its nodes are " << farthest
            << " times its size away from rest; its elasticity finds no balance with its load (expected a "
               "smaller one, or a stiffer law), or the steps are too long for it; ";
  }
  return message.str();
}

/// Names the first joint whose gap is not a finite number. Rigid islands evaluate no gaps.
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
  if (!term.empty()) return "the term at fault is " + term;
  std::ostringstream message;
  message << "the motion has grown beyond all bounds, which a smaller step than " << before.h
          << " s may cure";
  return message.str();
}

}  // namespace pliant::failure_report
