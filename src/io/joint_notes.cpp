#include <pliant/io/joint_notes.h>

#include <algorithm>

#include <pliant/io/number_text.h>

namespace pliant {

std::string redundancy_note(const Simulation& simulation) {
  constexpr int kShown = 6;  // names of joints
  const Model& model = simulation.model();
  const State& state = simulation.state();
  if (model.joints().empty()) return {};
  Workspace<double> work;
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  const std::vector<int> redundant = redundant_rows(model, work.joints);
  int rows = 0, joints = 0;
  std::string names;
  for (int j = 0; j < static_cast<int>(model.joints().size()); ++j) {
    if (redundant[static_cast<std::size_t>(j)] == 0) continue;
    rows += redundant[static_cast<std::size_t>(j)];
    if (++joints <= kShown)
      names += (joints == 1 ? " '" : ", '") + model.joints()[static_cast<std::size_t>(j)].joint->name() + "'";
  }
  if (rows == 0) return {};
  if (joints > kShown) names += " and others";
  return count_text(rows, "row") + " of " + count_text(joints, "joint") +
         " follow from those of others and are left to them:" + names;
}

std::string solver_note(const Model& model) {
  bool blocks = false, augmented = false;
  for (const Island& island : model.islands()) (island.augmented ? augmented : blocks) = true;
  if (blocks && augmented) return "blocks and augmented";
  return blocks ? "blocks" : (augmented ? "augmented" : "");
}

double widest_closed_gap(const Simulation& simulation) {
  double widest = 0;
  for (std::size_t j = 0; j < simulation.state().joints.size(); ++j)
    if (simulation.state().joints[j] == JointMode::closed)
      widest = std::max(widest, simulation.model().gap(simulation.state(), static_cast<int>(j)));
  return widest;
}

}  // namespace pliant
