// The rows of the joints, Eqs. (12) and (13), and the blocks of W_c = C_q M^-1 C_q^T:
//   baumgarte()       2 alpha C_dot + beta^2 C
//   wanted()          -gamma + 2 alpha C_dot + beta^2 C; IslandForces::correct (solve_joints-inl.h) uses it
//   evaluate_joint()  C, C_dot, C_q and bias = -gamma of a joint
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <pliant/body/constraint/constraints.h>
#include <pliant/body/dynamics.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace detail {

/// Returns Baumgarte's terms 2 alpha C_dot + beta^2 C of joint j; zero if the joint has no such terms.
template <class S>
VecMax<S, kMaxJointRows> baumgarte(const Model& model, const ConstraintWorkspace<S>& joints, int j) {
  const JointModel& joint = model.joints()[at(j)];
  const JointMode mode = joints.modes[at(j)];
  auto rows = [&](const VecX<S>& of) { return of.segment(joint.row, joint.rows); };
  if (!acts(mode) || (mode == JointMode::closed && !joints.stabilise_closed))
    return VecMax<S, kMaxJointRows>::Constant(joint.rows, S(0.0));
  const double alpha = joints.gains.alpha, beta2 = joints.gains.beta * joints.gains.beta;
  // A gap that would close faster than the largest speed closes at that speed.
  S factor(beta2);
  if (mode == JointMode::closing) {
    const S gap = math::sqrt_from_zero(S(rows(joints.C).squaredNorm()));
    const double largest = 2 * alpha * joints.max_speed * joint.length;
    if (plain(gap) * beta2 > largest) factor = S(largest) / gap;
  }
  return S(2 * alpha) * rows(joints.C_dot) + factor * rows(joints.C);
}

}  // namespace detail

template <class S>
VecMax<S, kMaxJointRows> wanted(const Model& model, const ConstraintWorkspace<S>& joints, int j) {
  const JointModel& joint = model.joints()[at(j)];
  // Eq. (13) with Baumgarte's terms: -gamma + 2 alpha C_dot + beta^2 C
  return joints.bias.segment(joint.row, joint.rows) + detail::baumgarte(model, joints, j);
}

namespace detail {

/// C_q^T or M^-1 C_q^T of a side: n_x x rows.
template <class S, int Velocities, int Rows>
using FixedSide = Eigen::Map<Eigen::Matrix<S, Velocities, Rows>>;
template <class S, int Velocities, int Rows>
using ConstSide = Eigen::Map<const Eigen::Matrix<S, Velocities, Rows>>;

/// Returns the motion of a port of a part. x_ddot is the acceleration for constant generalised velocities,
///   R b,   b = omega x (omega x p) + 2 omega x (J q_s_dot + d_dot) + J_dot q_s_dot,
/// which gives gamma of Eq. (13). For a prescribed motion x_ddot is the whole acceleration.
template <class S>
PointMotion<S> port_motion(const PartModel& part, double t, const PartWorkspace<S>& w, int port) {
  PointMotion<S> motion{w.port_x[at(port)], w.port_x_dot[at(port)], Vec3<S>::Constant(S(0.0))};
  if (part.motion != nullptr) {
    const MovingFrame frame = part.motion->at(t);
    motion.x_ddot = frame.acceleration(frame.R * part.rigid_ports[at(port)].p).template cast<S>();
  }
  if (part.q0 < 0) return motion;
  const PointJet<S>& jet = w.ports[at(port)];
  const Vec3<S> omega = w.v_r.template segment<3>(3);
  Vec3<S> b = omega.cross(omega.cross(jet.p));
  if (part.n_s > 0 || part.local != nullptr) b += S(2.0) * omega.cross(jet.p1) + jet.p2;
  motion.x_ddot = w.R * b;
  return motion;
}

/// Adds (C_x L)^T of a port to C_q^T of its side, with L = R [I, -[p]x, J] of Eq. (9). For a part that
/// deforms locally, L also has the block R for d_dot of the port. C_x: rows x 3, by columns.
template <class S>
void add_port_to_Cq(const PartModel& part, const PartWorkspace<S>& w, int port, int rows, const S* C_x,
                    S* Cq) {
  const PointJet<S>& jet = w.ports[at(port)];
  const int n = part.n_x();
  for (int r = 0; r < rows; ++r, Cq += n) {
    const S x = C_x[r], y = C_x[rows + r], z = C_x[2 * rows + r];
    const Vec3<S> push(w.R(0, 0) * x + w.R(1, 0) * y + w.R(2, 0) * z,
                       w.R(0, 1) * x + w.R(1, 1) * y + w.R(2, 1) * z,
                       w.R(0, 2) * x + w.R(1, 2) * y + w.R(2, 2) * z);
    const Vec3<S> turn = jet.p.cross(push);
    for (int i = 0; i < 3; ++i) {
      Cq[i] += push[i];
      Cq[3 + i] += turn[i];
    }
    for (int k = 0; k < part.n_s; ++k) Cq[6 + k] += jet.J.col(k).dot(push);
    const int place = part.local == nullptr ? -1 : part.port_place[at(port)];
    if (place >= 0)
      for (int i = 0; i < 3; ++i) Cq[6 + part.n_s + 3 * place + i] += push[i];
  }
}

/// Computes C, C_dot, bias and C_q^T of joint j, Eqs. (12) and (13), if the joint acts or is one-sided and
/// slack. Otherwise sets C_q^T to zero.
template <class S>
void evaluate_joint(const Model& model, int j, double t, const std::vector<PartWorkspace<S>>& parts,
                    ConstraintWorkspace<S>& work) {
  const JointModel& joint = model.joints()[at(j)];
  for (const JointSide& side : joint.sides) {
    const int size = model.parts()[at(side.part)].n_x() * joint.rows;
    work.Cq.segment(side.offset, size).setConstant(S(0.0));
    if (joint.first_offset >= 0) work.Cq.segment(joint.first_offset, size).setConstant(S(0.0));
  }
  if (!acts(work.modes[at(j)]) && !(joint.joint->one_sided() && work.modes[at(j)] == JointMode::slack))
    return;
  std::array<PointMotion<S>, kMaxJointPoints> motion;
  JointRows<S> rows;
  const int n_points = joint.joint->n_points();
  for (int k = 0; k < n_points; ++k) {
    const PortRef& ref = joint.at[at(k)];
    if (ref.part >= 0) {
      motion[at(k)] = port_motion(model.parts()[at(ref.part)], t, parts[at(ref.part)], ref.port);
      continue;
    }
    const Vec3<Taylor2<double>> x = joint.joint->points()[at(k)].world.at(t);
    for (int i = 0; i < 3; ++i) {
      motion[at(k)].x[i] = S(x[i].v);
      motion[at(k)].x_dot[i] = S(x[i].d);
      motion[at(k)].x_ddot[i] = S(x[i].dd);
    }
  }
  joint.joint->evaluate(t, motion.data(), rows);
  work.C.segment(joint.row, joint.rows) = rows.C;
  work.C_dot.segment(joint.row, joint.rows) = rows.C_dot;
  work.bias.segment(joint.row, joint.rows) = rows.bias;
  for (int k = 0; k < n_points; ++k) {
    const PortRef& ref = joint.at[at(k)];
    for (const JointSide& side : joint.sides) {
      if (side.part != ref.part) continue;
      const PartModel& part = model.parts()[at(side.part)];
      const S* C_x = rows.C_x.data() + 3 * k * joint.rows;
      add_port_to_Cq(part, parts[at(side.part)], ref.port, joint.rows, C_x, work.Cq.data() + side.offset);
      if (joint.first_offset >= 0 && k < joint.joint->n_first())
        add_port_to_Cq(part, parts[at(side.part)], ref.port, joint.rows, C_x,
                       work.Cq.data() + joint.first_offset);
    }
  }
}

/// Computes Y = M^-1 C_q^T of the side that starts at an offset.
template <class S>
void solve_side(const PartModel& part, const PartWorkspace<S>& w, int rows, int offset,
                ConstraintWorkspace<S>& work) {
  const int n = part.n_x();
  const S* Cq = work.Cq.data() + offset;
  S* Y = work.Y.data() + offset;
  if constexpr (std::is_same_v<S, double>) {
    if (w.rigid != nullptr && rows == 3) {
      FixedSide<S, 6, 3>(Y).noalias() = w.rigid->rigid_mass->inverse.lazyProduct(ConstSide<S, 6, 3>(Cq));
      return;
    }
    if (part.local != nullptr) {
      Eigen::Map<MatX<S>>(Y, n, rows).noalias() = w.local->A * Eigen::Map<const MatX<S>>(Cq, n, rows);
      return;
    }
  }
  std::copy_n(Cq, rows * n, Y);
  if (rows == 3 && w.rigid == nullptr)
    w.factor.template solve_columns<3>(Y);
  else
    for (int r = 0; r < rows; ++r) w.solve_mass(Eigen::Map<VecX<S>>(Y + r * n, n));
}

/// Computes Y = M^-1 C_q^T of the sides of joint j.
template <class S>
void solve_sides(const Model& model, int j, const std::vector<PartWorkspace<S>>& parts,
                 ConstraintWorkspace<S>& work) {
  const JointModel& joint = model.joints()[at(j)];
  for (const JointSide& side : joint.sides) {
    const PartModel& part = model.parts()[at(side.part)];
    solve_side(part, parts[at(side.part)], joint.rows, side.offset, work);
    if (joint.first_offset >= 0) solve_side(part, parts[at(side.part)], joint.rows, joint.first_offset, work);
  }
}

/// Calls evaluate(i) for the parts i of an island in their order, each part before the first joint on the
/// part. Does nothing if `evaluate` is empty.
class PartsInTurn {
 public:
  PartsInTurn(const Island& island, const EvaluatePart& evaluate) : island_(island), evaluate_(evaluate) {
    if (!evaluate) next_ = island.parts.size();
  }
  void evaluate_for(const JointModel& joint) {
    for (const JointSide& side : joint.sides) evaluate_to(at(side.place) + 1);
  }
  void evaluate_remaining() { evaluate_to(island_.parts.size()); }

 private:
  void evaluate_to(std::size_t end) {
    for (; next_ < end; ++next_) evaluate_(island_.parts[next_]);
  }

  const Island& island_;
  const EvaluatePart& evaluate_;
  std::size_t next_ = 0;
};

}  // namespace detail

template <class S>
void evaluate_joints(const Model& model, const Island& island, double t,
                     const std::vector<PartWorkspace<S>>& parts, ConstraintWorkspace<S>& work,
                     const EvaluatePart& evaluate) {
  detail::PartsInTurn in_turn(island, evaluate);
  for (const int j : island.joints) {
    in_turn.evaluate_for(model.joints()[at(j)]);
    detail::evaluate_joint(model, j, t, parts, work);
  }
  in_turn.evaluate_remaining();
  for (const int j : island.strings) detail::evaluate_joint(model, j, t, parts, work);
}

namespace detail {

/// Computes M^-1 C_q^T and the factors of an island. Calls act(j) for each joint j before its C_q^T is read.
template <class S, class F>
void factor_after(const Model& model, const Island& island, const std::vector<PartWorkspace<S>>& parts,
                  ConstraintWorkspace<S>& work, F&& act) {
  const auto number = static_cast<std::size_t>(&island - model.islands().data());
  work.W_c[number].factor(model, island, parts, work, false, [&](int j) {
    act(j);
    solve_sides(model, j, parts, work);
  });
  const bool open = std::any_of(island.joints.begin(), island.joints.end(),
                                [&](int j) { return work.modes[at(j)] == JointMode::closing; });
  if (open) work.W_closed[number].factor(model, island, parts, work, true, [](int) {});
}

}  // namespace detail

template <class S>
void factor_joints(const Model& model, const Island& island, const std::vector<PartWorkspace<S>>& parts,
                   ConstraintWorkspace<S>& work) {
  detail::factor_after(model, island, parts, work, [](int) {});
}

template <class S>
void evaluate_and_factor_joints(const Model& model, const Island& island, double t,
                                const std::vector<PartWorkspace<S>>& parts, ConstraintWorkspace<S>& work,
                                const EvaluatePart& evaluate) {
  detail::PartsInTurn in_turn(island, evaluate);
  if (island.augmented) in_turn.evaluate_remaining();  // the augmented matrix needs the masses of all parts
  detail::factor_after(model, island, parts, work, [&](int j) {
    in_turn.evaluate_for(model.joints()[at(j)]);
    detail::evaluate_joint(model, j, t, parts, work);
  });
  in_turn.evaluate_remaining();
  for (const int j : island.strings) detail::evaluate_joint(model, j, t, parts, work);
}

template <class S>
double diagonal_of_ends(const Model& model, const ConstraintWorkspace<S>& work, int j, int row) {
  const JointModel& joint = model.joints()[at(j)];
  double sum = 0;
  for (const JointSide& side : joint.sides) {
    const int n = model.parts()[at(side.part)].n_x(), first = joint.first_offset + row * n;
    for (int i = 0; i < n; ++i) {
      double Cq = plain(work.Cq[side.offset + row * n + i]), Y = plain(work.Y[side.offset + row * n + i]);
      if (joint.first_offset >= 0) {
        const double Cq_first = plain(work.Cq[first + i]), Y_first = plain(work.Y[first + i]);
        sum += Cq_first * Y_first;
        Cq -= Cq_first;
        Y -= Y_first;
      }
      sum += Cq * Y;
    }
  }
  return sum;
}

namespace detail {

/// Returns the factor, at least 1, by which the scales of the pivots (solve/pivots.h) of joint j are raised.
/// Rows of two joints that depend on each other look independent while the joints have a gap e. The ratios of
/// their pivots to the diagonal are then of the order (e / r)^2, where r is the distance between the points
/// of the two joints. With the factor, ratios up to (kOpenPivot e / length)^2 count as zero. length:
/// JointModel::length. Joints that have just become closed have gaps e up to kJustClosed lengths; for larger
/// gaps, and for joints that are not closed, the factor is 1.
template <class S>
double scale_of_open_rows(const JointModel& joint, const ConstraintWorkspace<S>& work, int j) {
  constexpr double kOpenPivot = 10, kJustClosed = 2e-3;
  if (work.modes[at(j)] != JointMode::closed) return 1;
  double square = 0;
  for (int r = 0; r < joint.rows; ++r) square += std::pow(plain(work.C[joint.row + r]), 2);
  if (square > std::pow(kJustClosed * joint.length, 2)) return 1;
  return std::max(1.0, std::pow(kOpenPivot / joint.length, 2) * square / Pivots<S>::kVanished);
}

}  // namespace detail

template <class S>
template <class F>
void JointFactor<S>::factor(const Model& model, const Island& island,
                            const std::vector<PartWorkspace<S>>& parts, const ConstraintWorkspace<S>& work,
                            bool closed_only, F&& prepare) {
  if (island.augmented) {
    for (const int j : island.joints) prepare(j);
    if constexpr (std::is_same_v<S, double>) {
      if (!augmented_) augmented_ = std::make_unique<AugmentedFactor>(model, island);
      augmented_->factor(parts, work, closed_only);
    }
    return;
  }
  blocks_.clear(island.pattern, work.rank);
  // Couplings are added joint by joint, while the joint and the joints that share parts with it are in the
  // cache.
  auto coupling = island.couplings.begin();
  for (const int j : island.joints) {
    prepare(j);
    const JointModel& joint = model.joints()[at(j)];
    const double open = detail::scale_of_open_rows(joint, work, j);
    for (int r = 0; (joint.first_offset >= 0 || open > 1) && r < joint.rows; ++r)
      blocks_.raise_scale(joint.island_row + r, open * diagonal_of_ends(model, work, j, r));
    for (; coupling != island.couplings.end() && coupling->later_joint() == j; ++coupling)
      if (is_selected(work.modes[at(coupling->row_joint)], closed_only) &&
          is_selected(work.modes[at(coupling->column_joint)], closed_only))
        couple(model, *coupling, work);
  }
  blocks_.factor();
}

template <class S>
void JointFactor<S>::couple(const Model& model, const Coupling& c, const ConstraintWorkspace<S>& work) {
  const int n = model.parts()[at(c.part)].n_x();
  const S *Cq = work.Cq.data() + c.row_offset, *Y = work.Y.data() + c.column_offset;
  S* block = blocks_.block(c.target);
  if (n == 6 && c.rows == 3 && c.columns == 3) {
    detail::FixedSide<S, 3, 3>(block) +=
        detail::ConstSide<S, 6, 3>(Cq).transpose().lazyProduct(detail::ConstSide<S, 6, 3>(Y));
    return;
  }
  for (int k = 0; k < c.columns; ++k)
    for (int r = 0; r < c.rows; ++r) {
      S sum(0.0);
      for (int i = 0; i < n; ++i) sum += Cq[r * n + i] * Y[k * n + i];
      block[k * c.rows + r] += sum;
    }
}

template <class S>
void JointFactor<S>::solve(VecX<S>& x) const {
  if constexpr (std::is_same_v<S, double>) {
    if (augmented_) return augmented_->solve(x);
  } else if (values_ != nullptr) {
    VecX<double> value(x.size()), slope(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      value[i] = x[i].v;
      slope[i] = x[i].d[0];
    }
    values_->solve(value);
    values_->solve(slope);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      x[i].v = value[i];
      x[i].d[0] = slope[i];
    }
    return;
  }
  blocks_.solve(x);
}

template <class S>
std::vector<bool> JointFactor<S>::dependent(const Model& model, const Island& island,
                                            const ConstraintWorkspace<S>& work) const {
  if constexpr (std::is_same_v<S, double>)
    if (augmented_) return dependent_rows(model, island, work);
  std::vector<bool> dependent(at(island.rows));
  for (int r = 0; r < island.rows; ++r) dependent[at(r)] = blocks_.excluded(r);
  return dependent;
}

template <class S>
bool JointFactor<S>::is_rough() const {
  constexpr double small_pivot = 1e-5;
  return augmented_ || values_ != nullptr || blocks_.smallest_pivot() < small_pivot;
}

PLIANT_INLINE double disagreement(const Model& model, const Workspace<double>& work, int j) {
  const JointModel& joint = model.joints()[at(j)];
  VecMax<double, kMaxJointRows> left = wanted(model, work.joints, j);
  for (const JointSide& side : joint.sides) {
    const VecX<double>& a_r = work.parts[at(side.part)].a_r;
    for (int r = 0; r < joint.rows; ++r)
      left[r] += work.joints.Cq.segment(side.offset + r * a_r.size(), a_r.size()).dot(a_r);
  }
  return joint.joint->one_sided() ? std::max(0.0, -left[0]) : left.norm();
}

template <class S>
Vec<S, kWorks> joint_power(const Model& model, const Workspace<S>& work) {
  Vec<S, kWorks> power = Vec<S, kWorks>::Constant(S(0.0));
  const ConstraintWorkspace<S>& joints = work.joints;
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const JointModel& joint = model.joints()[j];
    if (!acts(joints.modes[j])) continue;
    const auto lambda = joints.lambda.segment(joint.row, joint.rows);
    const S closing = lambda.dot(joints.C_dot.segment(joint.row, joint.rows));
    // If projection keeps a joint closed, C_dot is an error of the method, and lambda . C_dot is no work.
    if (joints.modes[j] == JointMode::closing || joints.stabilise_closed)
      power[static_cast<int>(Work::baumgarte)] += closing;
    if (!joint.driven) continue;
    S done(0.0);  // lambda C_q v: power of the joint on the parts
    for (const JointSide& side : joint.sides) {
      const PartModel& part = model.parts()[at(side.part)];
      const PartWorkspace<S>& w = work.parts[at(side.part)];
      const int n = part.n_x();
      auto add = [&](const VecX<S>& v, int first) {
        for (int r = 0; r < joint.rows; ++r)
          for (int i = 0; i < v.size(); ++i)
            done += lambda[r] * joints.Cq[side.offset + r * n + first + i] * v[i];
      };
      add(w.v_r, 0);
      if constexpr (std::is_same_v<S, double>)
        if (part.local != nullptr) {
          VecX<double> buffer;
          add(at_points(part.joint_points, part.local->at_nodes(w.local->d_dot.data(), buffer)),
              6 + part.n_s);
        }
    }
    power[static_cast<int>(Work::anchors)] += done - closing;
  }
  return power;
}

PLIANT_INLINE std::vector<int> redundant_rows(const Model& model, const ConstraintWorkspace<double>& work) {
  std::vector<int> count(model.joints().size(), 0);
  for (std::size_t i = 0; i < model.islands().size(); ++i) {
    const Island& island = model.islands()[i];
    const std::vector<bool> dependent = work.W_c[i].dependent(model, island, work);
    for (const int j : island.joints) {
      const JointModel& joint = model.joints()[at(j)];
      if (!acts(work.modes[at(j)])) continue;
      for (int r = 0; r < joint.rows; ++r) count[at(j)] += dependent[at(joint.island_row + r)] ? 1 : 0;
    }
  }
  return count;
}

}  // namespace pliant
