// The forces of joints and one-sided rows at an evaluation, Eq. (14): closed joints first, then those that
// close, then what strings and limits push.
#include <algorithm>
#include <cmath>

#include <pliant/body/constraint/group.h>
#include <pliant/body/constraint/one_sided_rows.h>
#include <pliant/body/dynamics.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// Closing joints whose rows all but contradict each other would throw their parts away, as rods that pull
/// apart would: nothing is accelerated by more than this times what the gaps ask.
constexpr double kMostLever = 30;
/// Strings that would are as soft as this, and share what there is.
constexpr double kSoftClosing = 1e-3;

/// The joints of an island, and the accelerations x of its parts that they shape.
template <class S>
class Holding {
 public:
  Holding(const Model& model, const Island& island, Workspace<S>& work)
      : model_(model),
        island_(island),
        work_(work),
        joints_(work.joints),
        group_(model, work, island, false),
        closed_(model, work, island, true),
        kept_(joints_.vectors[group_.number()]) {
    group_.gather(kept_.before, [&](int i) -> const VecX<S>& { return group_.workspace(i).a_r; });
  }

  const Group<S, Eigen::Dynamic>& group() const { return group_; }
  const VecX<S>& x() const { return kept_.x; }

  /// x = before + what the joints add. Closed joints come first; those that close get what these leave them.
  void hold() {
    auto closing = [&](int j) { return joints_.modes[at(j)] == JointMode::closing; };
    const bool open = std::any_of(island_.joints.begin(), island_.joints.end(), closing);
    kept_.x = kept_.before;
    kept_.lambda.setConstant(island_.rows, S(0.0));
    correct(
        closed_, [&](int j) { return !closing(j); }, kept_.x, kept_.lambda);
    if (!open) return;
    add_closing(closing);
    correct(
        closed_, [&](int j) { return !closing(j); }, kept_.x, kept_.lambda);
  }
  /// The same with pushes on one-sided rows.
  template <class Lambda>
  void hold(const std::vector<OneSidedRow>& pushed, const Lambda& lambda) {
    for (std::size_t i = 0; i < pushed.size(); ++i)
      kept_.before += group_.push(pushed[i]) * lambda[static_cast<Eigen::Index>(i)];
    hold();
    for (std::size_t i = 0; i < pushed.size(); ++i) {
      const OneSidedRow& row = pushed[i];
      if (row.part < 0)
        joints_.lambda[model_.joints()[at(island_.strings[at(row.k)])].row] =
            lambda[static_cast<Eigen::Index>(i)];
      else
        kept_.x[group_.first(row.part) + 6 + row.k] = S(0.0);  // to the last bit
    }
  }

  void finish() {
    for (int i = 0; i < group_.parts(); ++i) work_.parts[at(group_.part(i))].a_r = group_.share(x(), i);
    for (const int j : island_.joints) {
      const JointModel& joint = model_.joints()[at(j)];
      joints_.lambda.segment(joint.row, joint.rows) = kept_.lambda.segment(joint.island_row, joint.rows);
    }
  }

 private:
  using Vectors = GroupVectors<S, Eigen::Dynamic>;

  /// Takes x to where C_q x = -wanted for the rows of some joints that act, and adds the forces to lambda;
  /// Eq. (14), with what M gives taken out.
  template <class Which>
  void correct(const Group<S, Eigen::Dynamic>& group, Which&& which, VecX<S>& x, VecX<S>& lambda) const {
    const int refinements = group.is_rough() ? 2 : 0;
    for (int pass = 0; pass <= refinements; ++pass) {
      group.joint_rows(x, kept_.rows);
      for (const int j : island_.joints) {
        const JointModel& joint = model_.joints()[at(j)];
        auto rows = kept_.rows.segment(joint.island_row, joint.rows);
        if (acts(joints_.modes[at(j)]) && which(j))
          rows += wanted(model_, joints_, j);
        else
          rows.setConstant(S(0.0));
      }
      lambda += group.correct(kept_.rows, x, !group.is_rough());
    }
  }

  /// What brings joints together that close, no part faster than kMostLever allows.
  template <class Closing>
  void add_closing(Closing&& closing) {
    const VecX<S> before = kept_.x, lambda = kept_.lambda;
    group_.joint_rows(before, kept_.rows);
    double asked = 0, most = 0;
    for (const int j : island_.joints) {
      if (!closing(j)) continue;
      const JointModel& joint = model_.joints()[at(j)];
      const VecMax<S, kMaxJointRows> more = wanted(model_, joints_, j);
      double square = 0;
      for (int r = 0; r < joint.rows; ++r)
        square += std::pow(plain(kept_.rows[joint.island_row + r]) + plain(more[r]), 2);
      asked = std::max(asked, std::sqrt(square));
    }
    correct(group_, closing, kept_.x, kept_.lambda);
    const VecX<S> change = kept_.x - before;
    for (int i = 0; i < group_.parts(); ++i) {
      double straight = 0, turning = 0;
      for (int k = 0; k < 3; ++k) {
        straight += std::pow(plain(change[group_.first(i) + k]), 2);
        turning += std::pow(plain(change[group_.first(i) + 3 + k]), 2);
      }
      most = std::max({most, std::sqrt(straight), group_.model(i).part->size() * std::sqrt(turning)});
    }
    if (!(most > kMostLever * asked)) return;
    const S share(kMostLever * asked / most);
    kept_.x = before + share * change;
    kept_.lambda = lambda + share * (kept_.lambda - lambda);
  }

  const Model& model_;
  const Island& island_;
  Workspace<S>& work_;
  ConstraintWorkspace<S>& joints_;
  Group<S, Eigen::Dynamic> group_, closed_;  ///< all joints that act; the closed ones, while others close
  Vectors& kept_;
};

}  // namespace

namespace {

/// Softens the strings that close, where one of them pushes out of all proportion to what they lack without
/// pushes, at x; whether one does.
bool soften_closing(const Island& island, const ConstraintWorkspace<double>& joints,
                    const Group<double, Eigen::Dynamic>& group, const VecX<double>& x,
                    OneSidedRows<Eigen::Dynamic>& rows) {
  auto closes = [&](const OneSidedRow& row) {
    return row.part < 0 && joints.modes[at(island.strings[at(row.k)])] == JointMode::closing;
  };
  double asked = 0, most = 0;
  rows.for_each_pushed([&](const OneSidedRow& row, double lambda) {
    if (!closes(row)) return;
    asked = std::max(asked, std::abs(row.bound - group.value(row, x)));
    most = std::max(most, lambda * group.value(row, group.response(row)));
  });
  if (!(most > kMostLever * asked)) return false;
  rows.soften(kSoftClosing, closes);
  return true;
}

}  // namespace

void solve_joints(const Model& model, const Island& island, std::vector<OneSidedRow> limits,
                  Workspace<double>& work) {
  Holding<double> holding(model, island, work);
  holding.hold();
  for (std::size_t k = 0; k < island.strings.size(); ++k) {
    const int j = island.strings[k];
    if (acts(work.joints.modes[at(j)]))
      limits.push_back({-1, static_cast<int>(k), 1, -wanted(model, work.joints, j)[0]});
  }
  std::vector<OneSidedRow>& pushed =
      work.joints.pushed[static_cast<std::size_t>(&island - model.islands().data())];
  pushed.clear();
  if (!limits.empty()) {
    OneSidedRows<Eigen::Dynamic> rows(holding.group());
    for (const OneSidedRow& row : limits) rows.add(row);
    rows.meet(holding.x());
    if (soften_closing(island, work.joints, holding.group(), holding.x(), rows)) rows.meet(holding.x());
    std::vector<double> pushes;
    rows.for_each_pushed([&](const OneSidedRow& row, double lambda) {
      pushed.push_back(row);
      pushes.push_back(lambda);
    });
    if (!pushed.empty())
      holding.hold(pushed,
                   Eigen::Map<const VecX<double>>(pushes.data(), static_cast<Eigen::Index>(pushes.size())));
  }
  holding.finish();
}

void solve_joints(const Model& model, const Island& island, Workspace<Dual<1>>& work) {
  using S = Dual<1>;
  Holding<S> holding(model, island, work);
  holding.hold();
  const std::vector<OneSidedRow>& pushed =
      work.joints.pushed[static_cast<std::size_t>(&island - model.islands().data())];
  if (!pushed.empty()) {
    // The small dense system of the pushes, as blocks of one row.
    const int n = static_cast<int>(pushed.size());
    std::vector<std::pair<int, int>> all;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < i; ++k) all.emplace_back(i, k);
    const BlockPattern pattern(std::vector<int>(pushed.size(), 1), all, cardinality_order);
    BlockFactor<S> W;
    W.clear(pattern);
    VecX<S> lambda(n);
    for (int k = 0; k < n; ++k) {
      const OneSidedRow& row = pushed[at(k)];
      const VecX<S> response = holding.group().response(row);
      for (int i = k; i < n; ++i)
        *W.block(pattern.place(i, k).offset) = holding.group().value(pushed[at(i)], response);
      *W.block(pattern.place(k, k).offset) *= S(1 + row.softness);
      const S bound = row.part >= 0 ? S(0.0) : S(-wanted(model, work.joints, island.strings[at(row.k)])[0]);
      lambda[k] = bound - holding.group().value(row, holding.x());
    }
    W.factor();
    W.solve(lambda);
    holding.hold(pushed, lambda);
  }
  holding.finish();
}

}  // namespace pliant
