// A group: one part without joints, or the parts of an island. The velocities v_r = (R^T c_dot, omega,
// q_s_dot) of these parts, one part after the other, form one vector x. For a part that deforms locally,
// d_dot of the points at its joints follows its v_r. Joints and one-sided rows (limits of parameters,
// strings) act on x.
#pragma once

#include <algorithm>

#include <pliant/body/dynamics.h>
#include <pliant/math/index.h>

namespace pliant {

/// Sets x to the velocities of a part in its group, from the velocities v of all parts.
void gather_velocity(const PartModel& m, const PartWorkspace<double>& w, const VecX<double>& v,
                     Eigen::Ref<VecX<double>> x);

/// Max: largest number of velocities of a part without joints; Eigen::Dynamic for an island.
template <class S, int Max>
class Group {
 public:
  using Vector = VecMax<S, Max>;
  static constexpr int kMax = Max;

  /// Makes the group of one part without joints.
  Group(const Model& model, Workspace<S>& work, int part)
      : model_(&model), work_(&work), alone_(part), size_(velocities(part)) {}
  /// Makes the group of an island. closed_only: whether only closed joints react to pushes and corrections,
  /// so that joints that are still closing may open. If false, all joints that act react.
  Group(const Model& model, Workspace<S>& work, const Island& island, bool closed_only)
      : model_(&model), work_(&work), island_(&island), size_(island.n_v) {
    closed_only_ = closed_only && std::any_of(island.joints.begin(), island.joints.end(), [&](int j) {
                     return work.joints.modes[at(j)] == JointMode::closing;
                   });
  }

  int size() const { return size_; }  ///< length of x
  int parts() const { return island_ == nullptr ? 1 : static_cast<int>(island_->parts.size()); }
  int part(int i) const { return island_ == nullptr ? alone_ : island_->parts[at(i)]; }
  /// First entry of part i of the group in x.
  int first(int i) const { return island_ == nullptr ? 0 : island_->first[at(i)]; }
  const PartModel& model(int i) const { return model_->parts()[at(part(i))]; }
  const PartWorkspace<S>& workspace(int i) const { return work_->parts[at(part(i))]; }
  const Island* island() const { return island_; }
  /// Number of the island of the group; only for the group of an island.
  std::size_t number() const { return static_cast<std::size_t>(island_ - model_->islands().data()); }

  /// Sets x from velocities_of(i), the velocities of each part i in the group.
  template <class F>
  void gather(Vector& x, F&& velocities_of) const {
    x.resize(size_);
    for (int i = 0; i < parts(); ++i) x.segment(first(i), velocities(part(i))) = velocities_of(i);
  }
  /// Returns the entries of part i in x.
  auto share(Vector& x, int i) const { return x.segment(first(i), velocities(part(i))); }
  auto share(const Vector& x, int i) const { return x.segment(first(i), velocities(part(i))); }

  /// Returns the value that a one-sided row bounds from below, see OneSidedRow.
  S value(const OneSidedRow& row, const Vector& x) const;
  /// Returns the change of x that a unit force (or impulse) on a row causes if the joints exert no forces.
  Vector push(const OneSidedRow& row) const;
  /// Returns the change of x that a unit force (or impulse) on a row causes while the joints act.
  Vector response(const OneSidedRow& row) const;

  /// Computes rows = C_q x of the joints of the island.
  template <class V>
  void joint_rows(const V& x, VecX<S>& rows) const {
    rows.setConstant(island_->rows, S(0.0));
    for_each_side(work_->joints.Cq, [&](int row, int n_rows, int start, int n, const S* Cq) {
      if (n == 6 && n_rows == 3) {
        rows.template segment<3>(row) += BallSide(Cq).transpose().lazyProduct(x.template segment<6>(start));
        return;
      }
      for (int r = 0; r < n_rows; ++r)
        for (int i = 0; i < n; ++i) rows[row + r] += Cq[r * n + i] * x[start + i];
    });
  }
  /// Returns whether a result of correct() needs iterative refinement.
  bool is_rough() const { return factor().is_rough() || (island_ != nullptr && island_->uneven); }
  /// Adds to x the least change in the mass metric that removes `rows` from C_q x: M^-1 C_q^T lambda with W_c
  /// lambda = -rows. Returns lambda, which the next call overwrites. W_c may be the matrix of an earlier
  /// configuration. Then lambda is approximate, but the forces act along the present C_q^T, so that the two
  /// ends of a joint have opposite forces. as_factored: whether to use M^-1 C_q^T of the workspace. C_q must
  /// then be that of the factorisation.
  const VecX<S>& correct(const VecX<S>& rows, Vector& x, bool as_factored = false) const;

 private:
  /// C_q^T of a ball joint on a rigid part.
  using BallSide = Eigen::Map<const Eigen::Matrix<S, 6, 3>>;

  const JointFactor<S>& factor() const {
    return (closed_only_ ? work_->joints.W_closed : work_->joints.W_c)[number()];
  }
  /// Calls act(first row, rows, first velocity, velocities, values) for each side of each joint of the
  /// island. side_values: C_q^T or M^-1 C_q^T of all sides.
  template <class F>
  void for_each_side(const VecX<S>& side_values, F&& act) const {
    for (const int j : island_->joints) {
      const JointModel& joint = model_->joints()[at(j)];
      for (const JointSide& side : joint.sides)
        act(joint.island_row, joint.rows, island_->first[at(side.place)], velocities(side.part),
            side_values.data() + side.offset);
    }
  }
  /// Computes x = M^-1 C_q^T lambda.
  void response_to(const VecX<S>& lambda, bool as_factored, VecX<S>& x) const;
  int velocities(int part) const { return model_->parts()[at(part)].n_x(); }

  const Model* model_;
  Workspace<S>* work_;
  const Island* island_ = nullptr;
  int alone_ = -1;
  bool closed_only_ = false;
  int size_;
};

// Group instances that src/body compiles once, with the function bodies of group-inl.h.
extern template class Group<double, kMaxVelocities>;
extern template class Group<double, Eigen::Dynamic>;
extern template class Group<Dual<1>, kMaxVelocities>;
extern template class Group<Dual<1>, Eigen::Dynamic>;

}  // namespace pliant
