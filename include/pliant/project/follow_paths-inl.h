// The function follow_paths() of project.h: impulses at kinks of prescribed paths, where their rates jump.
#pragma once

#include <pliant/project/project.h>

#include <pliant/math/header_only.h>
#include <pliant/project/projection.h>

namespace pliant {

PLIANT_INLINE void follow_paths(StepContext& step, const Island& island, VecX<double>& impulses) {
  State& state = step.state;
  step.dynamics.factor_joints(step.t, state.q, state.v, state.joints, island, step.work);
  const Group<double, Eigen::Dynamic> group(step.model(), step.work, island, true);
  projection::Projection<Eigen::Dynamic> projection(step, group, projection::group_vectors(group, step.work));
  projection.add_impulses_to(impulses);
  double joints = 0, rows = 0;
  step.counters.limit_impulses += projection.velocities(joints, rows);
  state.work[static_cast<int>(Work::anchors)] += joints + rows;
}

}  // namespace pliant
