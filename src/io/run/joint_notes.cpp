#include <pliant/io/run/joint_notes.h>

#include <algorithm>
#include <cstddef>

#include <pliant/project/project.h>

#include <pliant/io/format/number_text.h>

namespace pliant {

namespace {

/// Rows of joints, and names of the first of these.
class NamedRows {
 public:
  void add(const JointModel& joint, int rows) {
    if (rows == 0) return;
    constexpr int kShown = 6;
    rows_ += rows;
    if (++joints_ <= kShown)
      names_ += (joints_ == 1 ? " '" : ", '") + joint.joint->name() + "'";
    else if (joints_ == kShown + 1)
      names_ += " and others";
  }
  /// "<what>: N rows of M joints, <names>"; empty without rows.
  std::string text(const std::string& what) const {
    if (rows_ == 0) return {};
    return what + ": " + count_text(rows_, "row") + " of " + count_text(joints_, "joint") + "," + names_;
  }

 private:
  int rows_ = 0, joints_ = 0;
  std::string names_;
};

/// Less than this part of what both ends of a joint do is rounding of what cancels.
constexpr double kCancelled = 1e-9;

/// Rows of a joint that no motion changes, such as the length of a rod whose ends coincide, or lie on one
/// part that does not change between them.
int rows_without_direction(const JointModel& joint, const Workspace<double>& work) {
  int count = 0;
  for (int r = 0; r < joint.rows; ++r) {
    double size = 0, ends = 0;
    for (const JointSide& side : joint.sides) {
      const Eigen::Index n = work.parts[static_cast<std::size_t>(side.part)].a_r.size();
      const auto Cq = work.joints.Cq.segment(side.offset + r * n, n);
      size += Cq.norm();
      if (joint.first_offset < 0) continue;
      const auto first = work.joints.Cq.segment(joint.first_offset + r * n, n);
      ends += first.norm() + (Cq - first).norm();
    }
    count += size > kCancelled * ends ? 0 : 1;
  }
  return count;
}

/// Whether a joint with a gap (m) has yet to close.
bool is_open(const Simulation& simulation, int j, double gap) {
  if (simulation.state().joints[static_cast<std::size_t>(j)] != JointMode::closing) return false;
  const JointModel& joint = simulation.model().joints()[static_cast<std::size_t>(j)];
  return simulation.dynamics().joint_policy().projected || gap > kClosedGap * joint.length;
}

/// Size of an impulse of a joint, N s, a torque's as of forces at its smaller part's surface.
double size_of(const ImpulseOnEngage& impulse, const JointModel& joint) {
  return impulse.impulse.force.norm() + impulse.impulse.torque.norm() / joint.length;
}

/// "2 N s", "2 N s and 0.1 N m s", or what of it is no rounding.
std::string text_of(const ImpulseOnEngage& impulse, const JointModel& joint) {
  const double size = size_of(impulse, joint), force = impulse.impulse.force.norm(),
               torque = impulse.impulse.torque.norm();
  const bool pushes = force > kCancelled * size, turns = torque / joint.length > kCancelled * size;
  return (pushes ? rounded_text(force) + " N s" : "") + (pushes && turns ? " and " : "") +
         (turns ? rounded_text(torque) + " N m s" : "");
}

}  // namespace

std::vector<std::string> redundancy_notes(const Simulation& simulation) {
  // Rows that follow from others agree with them to this part of what closes gaps of a length.
  constexpr double kAgrees = 1e-6;
  const Model& model = simulation.model();
  const State& state = simulation.state();
  if (model.joints().empty()) return {};
  Workspace<double> work;
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  const std::vector<int> redundant = redundant_rows(model, work.joints);
  const double rate = model.body().stabilization.rate;
  auto disagrees = [&](int j) {
    if (!acts(state.joints[static_cast<std::size_t>(j)])) return false;
    const JointModel& joint = model.joints()[static_cast<std::size_t>(j)];
    const double size = rate * rate * joint.length + wanted(model, work.joints, j).norm();
    return disagreement(model, work, j) > kAgrees * size;
  };
  auto share_part = [](const JointModel& a, const JointModel& b) {
    return std::any_of(a.sides.begin(), a.sides.end(), [&](const JointSide& side) {
      return std::any_of(b.sides.begin(), b.sides.end(),
                         [&](const JointSide& other) { return other.part == side.part; });
    });
  };
  NamedRows follow, disagree, directionless;
  std::vector<int> apart;
  for (int j = 0; j < static_cast<int>(model.joints().size()); ++j) {
    if (!disagrees(j)) continue;
    apart.push_back(j);
    disagree.add(model.joints()[static_cast<std::size_t>(j)],
                 model.joints()[static_cast<std::size_t>(j)].rows);
  }
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const JointModel& joint = model.joints()[j];
    const int without = redundant[j] > 0 ? std::min(redundant[j], rows_without_direction(joint, work)) : 0;
    directionless.add(joint, without);
    const bool open = std::any_of(apart.begin(), apart.end(), [&](int other) {
      return share_part(joint, model.joints()[static_cast<std::size_t>(other)]);
    });
    if (!open) follow.add(joint, redundant[j] - without);
  }
  std::vector<std::string> notes;
  for (const std::string& text :
       {follow.text("redundant, and left to the rows of others from which they follow"),
        disagree.text("in contradiction to others that they depend on, and may never close"),
        directionless.text("without direction where they are")})
    if (!text.empty()) notes.push_back(text);
  return notes;
}

std::string open_joints_note(const Simulation& simulation) {
  const Model& model = simulation.model();
  int widest = -1, open = 0;
  for (int j = 0; j < static_cast<int>(model.joints().size()); ++j) {
    const double gap = model.gap(simulation.state(), j);
    if (!is_open(simulation, j, gap)) continue;
    ++open;
    if (widest < 0 || gap > model.gap(simulation.state(), widest)) widest = j;
  }
  if (open == 0) return {};
  const Joint& joint = *model.joints()[static_cast<std::size_t>(widest)].joint;
  return "at t = " + rounded_text(simulation.time()) + " s " + count_text(open, "joint") +
         (open == 1 ? " is" : " are") + " still open: " + (open == 1 ? "" : "the widest, ") + joint.type() +
         " '" + joint.name() + "', by " + rounded_text(model.gap(simulation.state(), widest)) + " m";
}

std::vector<std::string> engage_notes(const Simulation& simulation, std::size_t first) {
  const std::vector<ImpulseOnEngage>& all = simulation.engage_impulses();
  auto joint_of = [&](const ImpulseOnEngage& impulse) -> const JointModel& {
    return simulation.model().joints()[static_cast<std::size_t>(impulse.joint)];
  };
  auto told = [&](std::size_t i) {  // its path is known to have such rates
    return std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i),
                       [&](const ImpulseOnEngage& of) { return of.of_path && of.joint == all[i].joint; });
  };
  std::vector<std::string> notes;
  for (std::size_t i = first; i < all.size();) {
    std::size_t end = i, largest = i;
    for (; end < all.size() && all[end].time == all[i].time && all[end].of_path == all[i].of_path; ++end)
      if (size_of(all[end], joint_of(all[end])) > size_of(all[largest], joint_of(all[largest])))
        largest = end;
    const JointModel& joint = joint_of(all[largest]);
    const auto count = static_cast<int>(end - i);
    if (!all[i].of_path || !told(largest))
      notes.push_back("at t = " + rounded_text(all[i].time) + " s " +
                      (all[i].of_path ? "the rate of a path jumps: " : "") + joint.joint->type() + " '" +
                      joint.joint->name() + "' " + (all[i].of_path ? "follows" : "takes hold") +
                      " with an impulse of " + text_of(all[largest], joint) +
                      (count > 1 ? ", the largest of " + count_text(count, "joint") : ""));
    i = end;
  }
  return notes;
}

std::string solver_note(const Model& model) {
  bool blocks = false, augmented = false;
  for (const Island& island : model.islands()) (island.augmented ? augmented : blocks) = true;
  if (blocks && augmented) return "blocks and augmented";
  return blocks ? "blocks" : (augmented ? "augmented" : "");
}

Gaps widest_gaps(const Simulation& simulation) {
  Gaps gaps;
  for (int j = 0; j < static_cast<int>(simulation.model().joints().size()); ++j) {
    const JointMode mode = simulation.state().joints[static_cast<std::size_t>(j)];
    if (!acts(mode)) continue;
    const double gap = simulation.model().gap(simulation.state(), j);
    double& widest = is_open(simulation, j, gap) ? gaps.open : gaps.closed;
    widest = std::max(widest, gap);
  }
  return gaps;
}

}  // namespace pliant
