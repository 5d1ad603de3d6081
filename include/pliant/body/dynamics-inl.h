// The evaluation of the dynamics, stage by stage in the order of sections 2 to 4 of the paper, and the
// functions of Dynamics that run some of its stages.
#pragma once

#include <algorithm>
#include <functional>

#include <pliant/body/dynamics.h>
#include <pliant/body/stages/body_stages.h>
#include <pliant/body/stages/evaluation.h>
#include <pliant/body/stages/part_stages.h>
#include <pliant/math/header_only.h>

namespace pliant {

/// One evaluation. Each stage returns at once if it has nothing to do:
///   1 positions      x = c + R (s + d), x_dot = L v                                      Eqs. (1)-(9)
///   2 mass           M, g_q                                                              Eq. (11)
///   3 forces         f = g_q - K (q - rest) - D v + gravity + drag + f_q                 Eq. (11)
///   4 joints         C, C_q, gamma, Baumgarte's terms, then lambda                       Eqs. (12)-(14)
///   5 accelerations  M a = f + C_q^T lambda                                              Eq. (14)
/// f_q = L^T times the forces of the loads. Stages 1 to 3 run part by part, and M^-1 f follows for each part,
/// while the part is in the cache.
template <class S>
void Dynamics::evaluate(const Evaluation<S>& e) const {
  detail::start_evaluation<S>(e);
  detail::evaluate_parts<S>(e);          // 1 positions, 2 mass, 3 forces without loads
  detail::evaluate_loads<S>(e);          // 3 forces of loads
  detail::evaluate_islands<S>(e);        // 4 joints
  detail::evaluate_rigid_islands<S>(e);  // 1 to 5 of islands of rigid parts on ball joints
  detail::collect_accelerations<S>(e);   // 5 accelerations
}

PLIANT_INLINE void Dynamics::accelerations(double t, const VecX<double>& q, const VecX<double>& v,
                                           const State& modes, Workspace<double>& work, RankRule rank) const {
  work.joints.rank = rank;
  evaluate<double>({*this, t, q, v, work, &modes});
}

PLIANT_INLINE void Dynamics::rates(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                                   Workspace<double>& work, RankRule rank) const {
  work.joints.rank = rank;
  evaluate<double>({*this, t, q, v, work, &modes, nullptr, true});
}

PLIANT_INLINE void Dynamics::place_anchors(double t, const VecX<double>& q, const VecX<double>& v,
                                           const std::vector<JointMode>& modes, const Island& island,
                                           Workspace<double>& work) const {
  detail::size_joint_workspace<double>(*model_, work);
  for (const std::vector<int>* joints : {&island.joints, &island.strings})
    for (const int j : *joints)
      work.joints.modes[static_cast<std::size_t>(j)] = modes[static_cast<std::size_t>(j)];
  for (const int i : island.anchors) {
    const PartModel& m = model_->parts()[static_cast<std::size_t>(i)];
    PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(i)];
    if (m.motion != nullptr || w.port_x.empty()) detail::evaluate_positions<double>(m, t, q, v, w);
  }
}

PLIANT_INLINE void Dynamics::evaluate_joints(double t, const VecX<double>& q, const VecX<double>& v,
                                             const std::vector<JointMode>& modes, const Island& island,
                                             Workspace<double>& work) const {
  place_anchors(t, q, v, modes, island, work);
  auto place = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    detail::evaluate_positions<double>(model_->parts()[k], t, q, v, work.parts[k]);
  };
  pliant::evaluate_joints<double>(*model_, island, t, work.parts, work.joints, std::ref(place));
}

PLIANT_INLINE void Dynamics::factor_joints(double t, const VecX<double>& q, const VecX<double>& v,
                                           const std::vector<JointMode>& modes, const Island& island,
                                           Workspace<double>& work, RankRule rank) const {
  work.joints.rank = rank;
  place_anchors(t, q, v, modes, island, work);
  work.without_inertia.resize(work.parts.size());
  auto place = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    detail::evaluate_positions<double>(model_->parts()[k], t, q, v, work.parts[k]);
    detail::evaluate_mass<double>(model_->parts()[k], work.parts[k]);
    detail::factor_part_mass(*model_, i, work);
  };
  evaluate_and_factor_joints<double>(*model_, island, t, work.parts, work.joints, std::ref(place));
}

PLIANT_INLINE void Dynamics::evaluate_frame(double t, const VecX<double>& q, const VecX<double>& v, int part,
                                            Workspace<double>& work) const {
  work.parts.resize(model_->parts().size());
  work.without_inertia.resize(model_->parts().size());
  const PartModel& m = model_->parts()[static_cast<std::size_t>(part)];
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(part)];
  detail::evaluate_positions<double>(m, t, q, v, w);
  detail::evaluate_mass<double>(m, w);
}

PLIANT_INLINE void Dynamics::evaluate_masses(double t, const VecX<double>& q, const VecX<double>& v,
                                             const std::vector<int>& parts, Workspace<double>& work) const {
  for (const int i : parts) {
    evaluate_frame(t, q, v, i, work);
    detail::factor_part_mass(*model_, i, work);
  }
}

}  // namespace pliant
