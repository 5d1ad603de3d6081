// Function bodies of Group and of gather_velocity().
#pragma once

#include <pliant/body/constraint/group.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE void gather_velocity(const PartModel& m, const PartWorkspace<double>& w, const VecX<double>& v,
                                   Eigen::Ref<VecX<double>> x) {
  x.head(6 + m.n_s) = v.segment(m.v0, 6 + m.n_s);
  x.head<3>() = w.R.transpose() * v.segment<3>(m.v0);
  if (m.joint_points.empty()) return;
  VecX<double> buffer;
  x.tail(x.size() - 6 - m.n_s) =
      at_points(m.joint_points, m.local->at_nodes(v.data() + m.v0 + 6 + m.n_s, buffer));
}

template <class S, int Max>
S Group<S, Max>::value(const OneSidedRow& row, const Vector& x) const {
  if (row.part >= 0) return x[first(row.part) + 6 + row.k] * S(row.sign);
  const JointModel& string = model_->joints()[at(island_->strings[at(row.k)])];
  S sum(0.0);
  for (const JointSide& side : string.sides) {
    const int start = island_->first[at(side.place)];
    for (int i = 0; i < velocities(side.part); ++i) sum += work_->joints.Cq[side.offset + i] * x[start + i];
  }
  return sum * S(row.sign);
}

template <class S, int Max>
typename Group<S, Max>::Vector Group<S, Max>::push(const OneSidedRow& row) const {
  Vector x = Vector::Constant(size_, S(0.0));
  if (row.part >= 0) {
    auto force = share(x, row.part);
    force[6 + row.k] = S(row.sign);
    workspace(row.part).solve_mass(force);
    return x;
  }
  for (const JointSide& side : model_->joints()[at(island_->strings[at(row.k)])].sides) {
    VecMax<S, Max> force = work_->joints.Cq.segment(side.offset, velocities(side.part)) * S(row.sign);
    workspace(side.place).solve_mass(force);
    share(x, side.place) += force;
  }
  return x;
}

template <class S, int Max>
typename Group<S, Max>::Vector Group<S, Max>::response(const OneSidedRow& row) const {
  Vector x = push(row);
  if (island_ == nullptr) return x;
  VecX<S> rows;
  joint_rows(x, rows);
  correct(rows, x);
  return x;
}

template <class S, int Max>
const VecX<S>& Group<S, Max>::correct(const VecX<S>& rows, Vector& x, bool as_factored) const {
  const JointFactor<S>& factor = this->factor();
  GroupVectors<S, Eigen::Dynamic>& kept = work_->joints.vectors[number()];
  VecX<S>&lambda = kept.correction, &change = kept.change;
  lambda = -rows;
  factor.solve(lambda);
  response_to(lambda, as_factored, change);
  if (!factor.exact()) {
    VecX<S> more;
    joint_rows(change, more);
    more = -(rows + more);
    factor.solve(more);
    lambda += more;
    response_to(lambda, as_factored, change);
  }
  x += change;
  return lambda;
}

template <class S, int Max>
void Group<S, Max>::response_to(const VecX<S>& lambda, bool as_factored, VecX<S>& x) const {
  x.setConstant(size_, S(0.0));
  const ConstraintWorkspace<S>& joints = work_->joints;
  for_each_side(
      as_factored ? joints.Y : joints.Cq, [&](int row, int n_rows, int start, int n, const S* side) {
        if (n == 6 && n_rows == 3) {
          x.template segment<6>(start) += BallSide(side).lazyProduct(lambda.template segment<3>(row));
          return;
        }
        for (int r = 0; r < n_rows; ++r)
          for (int i = 0; i < n; ++i) x[start + i] += side[r * n + i] * lambda[row + r];
      });
  if (as_factored) return;
  for (int i = 0; i < parts(); ++i) workspace(i).solve_mass(x.segment(first(i), velocities(part(i))));
}

}  // namespace pliant
