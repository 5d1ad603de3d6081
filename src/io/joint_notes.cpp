#include <pliant/io/joint_notes.h>

#include <pliant/io/number_text.h>

namespace pliant {

std::string redundancy_note(const Simulation& simulation) {
  constexpr int kShown = 6;  // names of joints
  const Model& model = simulation.model();
  const State& state = simulation.state();
  if (model.joints().empty()) return {};
  Workspace<double> work;
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  int rows = 0, joints = 0;
  std::string names;
  for (int j = 0; j < static_cast<int>(model.joints().size()); ++j) {
    const int redundant = redundant_rows(model, work.joints, j);
    if (redundant == 0) continue;
    rows += redundant;
    if (++joints <= kShown)
      names += (joints == 1 ? " '" : ", '") + model.joints()[static_cast<std::size_t>(j)].joint->name() + "'";
  }
  if (rows == 0) return {};
  if (joints > kShown) names += " and others";
  return count_text(rows, "row") + " of " + count_text(joints, "joint") +
         " follow from those of others and are left to them:" + names;
}

}  // namespace pliant
