// Function bodies of stiff_projection_metric.h: setting and resetting the stiffening factor of each part.
#pragma once

#include <pliant/method/implicit/stiff_projection_metric.h>

#include <algorithm>

#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE StiffProjectionMetric::StiffProjectionMetric(const Dynamics& dynamics, double t, double c,
                                                           const State& state, Workspace<double>& work)
    : work_(work) {
  const Model& model = dynamics.model();
  if (!state.q.allFinite() || !state.v.allFinite()) return;
  for (std::size_t i = 0; i < work.parts.size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.q0 >= 0 && m.local == nullptr && m.n_s > 0 && !m.part->K_s().isZero(0))
      work.parts[i].stiffening = c * (m.part->beta() + c);
  }
  auto stiff = [&](int i) { return work.parts[static_cast<std::size_t>(i)].stiffening > 0; };
  try {
    for (const Island& island : model.islands())
      if (std::any_of(island.parts.begin(), island.parts.end(), stiff))
        dynamics.factor_joints(t, state.q, state.v, state.joints, island, work, RankRule::keep);
  } catch (...) {
    end();
    throw;
  }
}

PLIANT_INLINE void StiffProjectionMetric::end() {
  for (PartWorkspace<double>& w : work_.parts) w.stiffening = 0;
}

}  // namespace pliant
