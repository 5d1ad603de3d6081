#include <pliant/io/run/joint_notes.h>

#include <algorithm>
#include <cstddef>

#include <pliant/project/project.h>

#include <pliant/io/format/number_text.h>

namespace pliant {

namespace {

/// A number of constraint rows and the names of the first joints that have them.
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
  /// Returns the text "HEADING: N rows of M joints, NAMES"; empty without rows.
  std::string text(const std::string& heading) const {
    if (rows_ == 0) return {};
    return heading + ": " + count_text(rows_, "row") + " of " + count_text(joints_, "joint") + "," + names_;
  }

 private:
  int rows_ = 0, joints_ = 0;
  std::string names_;
};

/// A row of C_q or a component of an impulse is a rounding error if it is at most this fraction of the terms
/// from which it is computed.
constexpr double kCancelled = 1e-9;

/// Returns the number of constraint rows of a joint that are zero in C_q. An example is a rod whose ends
/// coincide, or whose ends are on one part that does not deform between them.
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

/// Returns whether joint j with a gap (m) is open: its mode is JointMode::closing. Without projection, the
/// gap must also be larger than kClosedGap times JointModel::length (the size of the smallest part).
bool is_open(const Simulation& simulation, int j, double gap) {
  if (simulation.state().joints[static_cast<std::size_t>(j)] != JointMode::closing) return false;
  const JointModel& joint = simulation.model().joints()[static_cast<std::size_t>(j)];
  return simulation.dynamics().joint_policy().projected || gap > kClosedGap * joint.length;
}

/// Returns the size of an impulse of a joint, N s. An angular impulse is divided by JointModel::length.
double size_of(const ImpulseOnEngage& impulse, const JointModel& joint) {
  return impulse.impulse.force.norm() + impulse.impulse.torque.norm() / joint.length;
}

/// Returns an impulse as text, for example "2 N s and 0.1 N m s", without components that are rounding
/// errors.
std::string text_of(const ImpulseOnEngage& impulse, const JointModel& joint) {
  const double size = size_of(impulse, joint), force = impulse.impulse.force.norm(),
               torque = impulse.impulse.torque.norm();
  const bool pushes = force > kCancelled * size, turns = torque / joint.length > kCancelled * size;
  return (pushes ? rounded_text(force) + " N s" : "") + (pushes && turns ? " and " : "") +
         (turns ? rounded_text(torque) + " N m s" : "");
}

}  // namespace

std::vector<std::string> redundancy_notes(const Simulation& simulation) {
  // A joint agrees with the other joints if its disagreement() is at most this fraction of the sum of two
  // accelerations. The first is the acceleration that the joint requires. The second is rate^2 times
  // JointModel::length, which closes a gap of this length.
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
       {follow.text("redundant constraints, implied by those of other joints"),
        disagree.text("constraints that at the present positions contradict those of other joints, and may "
                      "never close"),
        directionless.text("constraints without direction at the present positions")})
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

std::vector<std::string> engage_notes(const Simulation& simulation, std::size_t first,
                                      const std::vector<std::string>& earlier) {
  const std::vector<ImpulseOnEngage>& all = simulation.engage_impulses();
  auto joint_of = [&](const ImpulseOnEngage& impulse) -> const JointModel& {
    return simulation.model().joints()[static_cast<std::size_t>(impulse.joint)];
  };
  std::vector<std::string> notes;
  auto reported = [&](const std::string& subject) {
    auto has_subject = [&](const std::string& note) { return note.find(subject) != std::string::npos; };
    return std::any_of(earlier.begin(), earlier.end(), has_subject) ||
           std::any_of(notes.begin(), notes.end(), has_subject);
  };
  for (std::size_t i = first; i < all.size();) {
    std::size_t end = i, largest = i;
    for (; end < all.size() && all[end].time == all[i].time && all[end].of_path == all[i].of_path; ++end)
      if (size_of(all[end], joint_of(all[end])) > size_of(all[largest], joint_of(all[largest])))
        largest = end;
    const JointModel& joint = joint_of(all[largest]);
    const auto count = static_cast<int>(end - i);
    const std::string subject =
        std::string(all[i].of_path ? "the velocity of a prescribed path jumps: " : "") + joint.joint->type() +
        " '" + joint.joint->name() + "' " + (all[i].of_path ? "follows" : "engages");
    if (!all[i].of_path || !reported(subject))
      notes.push_back("at t = " + rounded_text(all[i].time) + " s " + subject + " with an impulse of " +
                      text_of(all[largest], joint) +
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
