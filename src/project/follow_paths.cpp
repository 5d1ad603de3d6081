// Where the rates at which hands move ends of joints jump.
#include "projection.h"

namespace pliant {

void follow_paths(const Dynamics& dynamics, double t, const Island& island, State& state,
                  Workspace<double>& work, StepCounters& counters, VecX<double>& impulses) {
  const Model& model = dynamics.model();
  dynamics.factor_joints(t, state.q, state.v, state.joints, island, work);
  const Group<double, Eigen::Dynamic> group(model, work, island, true);
  projection::Projection<Eigen::Dynamic> projection(dynamics, t, group, state, work,
                                                    projection::kept_vectors(group, work));
  projection.add_impulses_to(impulses);
  double joints = 0, rows = 0;
  counters.limit_impulses += projection.velocities(joints, rows);
  state.work[static_cast<int>(Work::anchors)] += joints + rows;
}

}  // namespace pliant
