// The forces of joints and one-sided rows at an evaluation, Eq. (14): closed joints first, then closing
// joints, then strings and limits.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <pliant/body/constraint/feasible_rows.h>
#include <pliant/body/constraint/group.h>
#include <pliant/body/constraint/one_sided_rows.h>
#include <pliant/body/dynamics.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace detail {

/// Closing joints whose rows nearly contradict each other, for instance rods that pull apart, would
/// accelerate their parts without bound. The accelerations are limited to this multiple of the largest
/// acceleration that Baumgarte's terms request.
inline constexpr double kMaxClosingRatio = 30;
/// Softness (OneSidedRow) of the rows of closing strings if the accelerations exceed the limit
/// kMaxClosingRatio. The strings then share the load.
inline constexpr double kClosingSoftness = 1e-3;

/// The forces of the joints of an island and the accelerations x of its parts. `before` contains the
/// accelerations without joints.
template <class S>
class IslandForces {
 public:
  IslandForces(const Model& model, const Island& island, Workspace<S>& work)
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

  /// Computes lambda and x for the joints: first for the closed joints, then for the closing joints in the
  /// directions that remain free.
  void solve() {
    auto closing = [&](int j) { return joints_.modes[at(j)] == JointMode::closing; };
    auto not_closing = [&](int j) { return !closing(j); };
    const bool open = std::any_of(island_.joints.begin(), island_.joints.end(), closing);
    kept_.x = kept_.before;
    kept_.lambda.setConstant(island_.rows, S(0.0));
    correct(closed_, not_closing, kept_.x, kept_.lambda);
    if (!open) return;
    add_closing(closing);
    correct(closed_, not_closing, kept_.x, kept_.lambda);
  }
  /// Computes lambda and x for the joints and given pushes on one-sided rows.
  template <class Lambda>
  void solve(const std::vector<OneSidedRow>& pushed, const Lambda& lambda) {
    for (std::size_t i = 0; i < pushed.size(); ++i)
      kept_.before += group_.push(pushed[i]) * lambda[static_cast<Eigen::Index>(i)];
    solve();
    for (std::size_t i = 0; i < pushed.size(); ++i) {
      const OneSidedRow& row = pushed[i];
      if (row.part < 0)
        joints_.lambda[model_.joints()[at(island_.strings[at(row.k)])].row] =
            lambda[static_cast<Eigen::Index>(i)];
      else
        kept_.x[group_.first(row.part) + 6 + row.k] = S(0.0);  // zero without rounding errors
    }
  }

  /// Stores the accelerations of the parts and lambda in the workspace.
  void store() {
    for (int i = 0; i < group_.parts(); ++i) work_.parts[at(group_.part(i))].a_r = group_.share(x(), i);
    for (const int j : island_.joints) {
      const JointModel& joint = model_.joints()[at(j)];
      joints_.lambda.segment(joint.row, joint.rows) = kept_.lambda.segment(joint.island_row, joint.rows);
    }
  }

 private:
  using Vectors = GroupVectors<S, Eigen::Dynamic>;

  /// Changes x so that C_q x + wanted = 0 for each acting joint j for which which(j) is true, and adds the
  /// forces that do this to lambda: Eq. (14) after elimination of M. adapt(rows) may change the residuals
  /// rows = C_q x + wanted before the forces make them zero.
  template <class Which, class Adapt>
  void correct(const Group<S, Eigen::Dynamic>& group, Which&& which, VecX<S>& x, VecX<S>& lambda,
               Adapt&& adapt) const {
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
      adapt(kept_.rows);
      lambda += group.correct(kept_.rows, x, !group.is_rough());
    }
  }

  template <class Which>
  void correct(const Group<S, Eigen::Dynamic>& group, Which&& which, VecX<S>& x, VecX<S>& lambda) const {
    correct(group, which, x, lambda, [](VecX<S>&) {});
  }

  /// Adds the forces of the closing joints. If rows depend on each other and request accelerations that
  /// contradict each other, the sum of the squared residuals C_q x + wanted is minimised. The forces are
  /// scaled down if they accelerate a part by more than kMaxClosingRatio times largest_request().
  template <class Closing>
  void add_closing(Closing&& closing) {
    const VecX<S> before = kept_.x, lambda = kept_.lambda;
    const double asked = largest_request(closing, before);
    const DependentRows<S> dependent(model_, island_, work_, group_);
    std::vector<bool> may_change(at(island_.rows));
    for (const int j : island_.joints)
      for (int r = 0; r < model_.joints()[at(j)].rows; ++r)
        may_change[at(model_.joints()[at(j)].island_row + r)] = closing(j);
    correct(group_, closing, kept_.x, kept_.lambda, [&](VecX<S>& rows) {
      if (!dependent.empty()) dependent.make_feasible(may_change, rows);
    });
    const VecX<S> change = kept_.x - before;
    const double largest = largest_acceleration(change);
    if (!(largest > kMaxClosingRatio * asked)) return;
    const S share(kMaxClosingRatio * asked / largest);
    kept_.x = before + share * change;
    kept_.lambda = lambda + share * (kept_.lambda - lambda);
  }
  /// Returns the largest |C_q x + wanted| of the closing joints, m/s^2.
  template <class Closing>
  double largest_request(Closing&& closing, const VecX<S>& x) const {
    group_.joint_rows(x, kept_.rows);
    double asked = 0;
    for (const int j : island_.joints) {
      if (!closing(j)) continue;
      const JointModel& joint = model_.joints()[at(j)];
      const VecMax<S, kMaxJointRows> more = wanted(model_, joints_, j);
      double square = 0;
      for (int r = 0; r < joint.rows; ++r)
        square += std::pow(plain(kept_.rows[joint.island_row + r]) + plain(more[r]), 2);
      asked = std::max(asked, std::sqrt(square));
    }
    return asked;
  }
  /// Returns the largest linear acceleration of a part, or of its surface by rotation, m/s^2.
  double largest_acceleration(const VecX<S>& change) const {
    double largest = 0;
    for (int i = 0; i < group_.parts(); ++i) {
      double straight = 0, turning = 0;
      for (int k = 0; k < 3; ++k) {
        straight += std::pow(plain(change[group_.first(i) + k]), 2);
        turning += std::pow(plain(change[group_.first(i) + 3 + k]), 2);
      }
      largest = std::max({largest, std::sqrt(straight), group_.model(i).size * std::sqrt(turning)});
    }
    return largest;
  }

  const Model& model_;
  const Island& island_;
  Workspace<S>& work_;
  ConstraintWorkspace<S>& joints_;
  Group<S, Eigen::Dynamic> group_, closed_;  ///< with all joints that act, and with the closed joints only
  Vectors& kept_;
};

/// Softens the rows of closing strings if the push on one of these rows changes the row by more than
/// kMaxClosingRatio times the largest violation at x, the accelerations without pushes. Returns whether the
/// rows were softened.
inline bool soften_closing(const Island& island, const ConstraintWorkspace<double>& joints,
                           const Group<double, Eigen::Dynamic>& group, const VecX<double>& x,
                           OneSidedRows<Eigen::Dynamic>& rows) {
  auto closes = [&](const OneSidedRow& row) {
    return row.part < 0 && joints.modes[at(island.strings[at(row.k)])] == JointMode::closing;
  };
  double asked = 0, largest = 0;
  rows.for_each_pushed([&](const OneSidedRow& row, double lambda) {
    if (!closes(row)) return;
    asked = std::max(asked, std::abs(row.bound - group.value(row, x)));
    largest = std::max(largest, lambda * group.value(row, group.response(row)));
  });
  if (!(largest > kMaxClosingRatio * asked)) return false;
  rows.soften(kClosingSoftness, closes);
  return true;
}

/// Adds the rows of the strings that act to the candidates for pushes.
inline void add_strings(const Model& model, const Island& island, const ConstraintWorkspace<double>& joints,
                        std::vector<OneSidedRow>& candidates) {
  for (std::size_t k = 0; k < island.strings.size(); ++k) {
    const int j = island.strings[k];
    if (acts(joints.modes[at(j)]))
      candidates.push_back({-1, static_cast<int>(k), 1, -wanted(model, joints, j)[0]});
  }
}

/// Returns the pushes lambda on the rows `pushed`, with their derivatives, from the small dense system of
/// these rows.
inline VecX<Dual<1>> solve_pushes(const Model& model, const Island& island,
                                  const IslandForces<Dual<1>>& forces,
                                  const ConstraintWorkspace<Dual<1>>& joints,
                                  const std::vector<OneSidedRow>& pushed) {
  using S = Dual<1>;
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
    const VecX<S> response = forces.group().response(row);
    for (int i = k; i < n; ++i)
      *W.block(pattern.place(i, k).offset) = forces.group().value(pushed[at(i)], response);
    *W.block(pattern.place(k, k).offset) *= S(1 + row.softness);
    const S bound = row.part >= 0 ? S(0.0) : S(-wanted(model, joints, island.strings[at(row.k)])[0]);
    lambda[k] = bound - forces.group().value(row, forces.x());
  }
  W.factor();
  W.solve(lambda);
  return lambda;
}

}  // namespace detail

PLIANT_INLINE void solve_joints(const Model& model, const Island& island, std::vector<OneSidedRow> limits,
                                Workspace<double>& work) {
  detail::IslandForces<double> forces(model, island, work);
  forces.solve();
  detail::add_strings(model, island, work.joints, limits);
  std::vector<OneSidedRow>& pushed = work.joints.pushed[forces.group().number()];
  pushed.clear();
  if (!limits.empty()) {
    OneSidedRows<Eigen::Dynamic> rows(forces.group());
    for (const OneSidedRow& row : limits) rows.add(row);
    rows.satisfy(forces.x());
    if (detail::soften_closing(island, work.joints, forces.group(), forces.x(), rows))
      rows.satisfy(forces.x());
    std::vector<double> pushes;
    rows.for_each_pushed([&](const OneSidedRow& row, double lambda) {
      pushed.push_back(row);
      pushes.push_back(lambda);
    });
    if (!pushed.empty())
      forces.solve(pushed,
                   Eigen::Map<const VecX<double>>(pushes.data(), static_cast<Eigen::Index>(pushes.size())));
  }
  forces.store();
}

PLIANT_INLINE void solve_joints(const Model& model, const Island& island, Workspace<Dual<1>>& work) {
  detail::IslandForces<Dual<1>> forces(model, island, work);
  forces.solve();
  const std::vector<OneSidedRow>& pushed = work.joints.pushed[forces.group().number()];
  if (!pushed.empty()) forces.solve(pushed, detail::solve_pushes(model, island, forces, work.joints, pushed));
  forces.store();
}

}  // namespace pliant
