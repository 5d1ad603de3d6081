// The right-hand side b of W_c lambda = -b if closing joints depend on each other. For example, three ball
// joints between two rigid parts have more rows than the parts have relative motions. Then there are vectors
// n with W_c n = 0, and a solution lambda exists only if n . b = 0. While these joints are open, Baumgarte's
// terms in b violate this condition.
#pragma once

#include <utility>
#include <vector>

#include <pliant/body/constraint/group.h>
#include <pliant/math/column_basis.h>
#include <pliant/math/index.h>

namespace pliant::detail {

/// The vectors n of an island with W_c n = 0, from its factor by blocks.
template <class S>
class DependentRows {
 public:
  /// Computes the vectors n. group: the group of the island with all joints that act, after an evaluation and
  /// factorisation. With the augmented matrix no vectors are computed: its lower right block -d gives a
  /// solution for every b.
  DependentRows(const Model& model, const Island& island, const Workspace<S>& work,
                const Group<S, Eigen::Dynamic>& group) {
    const ConstraintWorkspace<S>& joints = work.joints;
    if (island.augmented) return;
    const std::vector<bool> dependent = joints.W_c[group.number()].dependent(model, island, joints);
    std::vector<VecX<double>> vectors;
    VecX<S> x, rows;
    for (const int j : island.joints) {
      const JointModel& joint = model.joints()[at(j)];
      if (!acts(joints.modes[at(j)])) continue;
      for (int r = 0; r < joint.rows; ++r) {
        if (!dependent[at(joint.island_row + r)]) continue;
        x.setConstant(group.size(), S(0.0));
        for (const JointSide& side : joint.sides) {
          const int n = model.parts()[at(side.part)].n_x();
          x.segment(island.first[at(side.place)], n) += joints.Y.segment(side.offset + r * n, n);
        }
        group.joint_rows(x, rows);
        for (const int other : island.joints)
          if (!acts(joints.modes[at(other)]))
            rows.segment(model.joints()[at(other)].island_row, model.joints()[at(other)].rows)
                .setConstant(S(0.0));
        VecX<S> unused = x;
        vectors.push_back(plain_values(group.correct(rows, unused, true)));
        vectors.back()[joint.island_row + r] += 1;
      }
    }
    n_.resize(island.rows, static_cast<Eigen::Index>(vectors.size()));
    for (std::size_t k = 0; k < vectors.size(); ++k) n_.col(static_cast<Eigen::Index>(k)) = vectors[k];
  }

  bool empty() const { return n_.cols() == 0; }

  /// Changes the entries of b for which may_change is true as little as possible, in the sum of squares, so
  /// that n . b = 0 for all vectors n. may_change: one flag for each row of the island.
  void make_feasible(const std::vector<bool>& may_change, VecX<S>& b) const {
    MatX<double> changeable = n_.transpose();
    for (Eigen::Index r = 0; r < b.size(); ++r)
      if (!may_change[static_cast<std::size_t>(r)]) changeable.col(r).setZero();
    changeable = (changeable.array().abs() < kNoise).select(0, changeable);
    for_each_value(b, [&](auto&& get) {
      VecX<double> value(b.size());
      for (Eigen::Index r = 0; r < b.size(); ++r) value[r] = get(b[r]);
      const VecX<double> change = least_norm(changeable, n_.transpose() * value);
      for (Eigen::Index r = 0; r < b.size(); ++r) get(b[r]) -= change[r];
    });
  }

 private:
  /// Entries of a vector n below this number are rounding errors; the largest entry of n is at least 1.
  static constexpr double kNoise = 1e-6;

  static VecX<double> plain_values(const VecX<S>& of) {
    VecX<double> values(of.size());
    for (Eigen::Index i = 0; i < of.size(); ++i) values[i] = plain(of[i]);
    return values;
  }
  /// Calls act(get) with a get(x) that returns the value of a scalar x. For Dual<1>, calls act(get) again,
  /// with a get(x) that returns the derivative of x. The derivatives of the vectors n are neglected.
  template <class F>
  static void for_each_value(const VecX<double>& /*of*/, F&& act) {
    act([](auto& x) -> auto& { return x; });
  }
  template <class F>
  static void for_each_value(const VecX<Dual<1>>& /*of*/, F&& act) {
    act([](auto& x) -> auto& { return x.v; });
    act([](auto& x) -> auto& { return x.d[0]; });
  }

  MatX<double> n_;  ///< one column for each vector
};

}  // namespace pliant::detail
