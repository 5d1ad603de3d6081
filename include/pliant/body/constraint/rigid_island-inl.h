// Function bodies of RigidIsland: set-up, accelerations, and closing of joints.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <pliant/body/constraint/rigid_island.h>
#include <pliant/body/dynamics.h>
#include <pliant/body/joints/ball.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/math/rotation.h>

namespace pliant {

namespace detail {

/// Largest number of joints of a part in a rigid island. The number is bounded because the mobilities of all
/// pairs of joints are computed, for four parts at once.
inline constexpr int kMaxArms = 16;

/// Returns whether a joint is a ball joint without prescribed motion between two different parts, or between
/// a part and the world.
inline bool is_undriven_ball(const JointModel& m) {
  if (dynamic_cast<const JointOf<Ball>*>(m.joint) == nullptr || m.driven) return false;
  return m.at[0].part != m.at[1].part;
}

/// Returns the contribution of the fixed end of a joint to C = x_0 - x_1, m.
inline Vec3<double> fixed_end(const Model& model, const JointModel& joint) {
  Vec3<double> C = Vec3<double>::Zero();
  for (std::size_t end = 0; end < 2; ++end) {
    const PortRef& ref = joint.at[end];
    const double sign = end == 0 ? 1 : -1;
    if (ref.part < 0) {
      C += sign * joint.joint->points()[end].world.value(0);
      continue;
    }
    const PartModel& m = model.parts()[at(ref.part)];
    if (m.q0 < 0) C += sign * (m.part->c0() + m.R0 * m.rigid_ports[at(ref.port)].p);
  }
  return C;
}

/// Returns entry k of each of four parts, whose entries in x start at `first`.
inline Pack gather_lanes(const VecX<double>& x, const std::array<int, Pack::kLanes>& first, int k) {
  return {x[first[0] + k], x[first[1] + k], x[first[2] + k], x[first[3] + k]};
}
/// Returns entries k to k + 2 of each of four parts.
inline Vec3<Pack> gather_lanes3(const VecX<double>& x, const std::array<int, Pack::kLanes>& first, int k) {
  return {gather_lanes(x, first, k), gather_lanes(x, first, k + 1), gather_lanes(x, first, k + 2)};
}

template <class M>
using Lane = Eigen::Matrix<double, M::RowsAtCompileTime, M::ColsAtCompileTime>;
template <class M>
Lane<M> lane_of(const M& packs, int lane) {
  Lane<M> one;
  for (Eigen::Index i = 0; i < packs.size(); ++i) one.data()[i] = packs.data()[i][lane];
  return one;
}
template <class M>
void set_lane(M& packs, int lane, const Lane<M>& value) {
  for (Eigen::Index i = 0; i < packs.size(); ++i) packs.data()[i].set(lane, value.data()[i]);
}

}  // namespace detail

PLIANT_INLINE bool RigidIsland::applies_to(const Model& model, const Island& island) {
  auto rigid = [&](int i) {
    const PartModel& m = model.parts()[at(i)];
    return m.rigid_mass != nullptr && !m.part->has_diagonal_mass() && m.drag == 0 &&
           !m.rigid_mass->factor.any_excluded();
  };
  std::vector<int> arms(island.parts.size(), 0);
  for (const int j : island.joints)
    for (const JointSide& side : model.joints()[at(j)].sides) ++arms[at(side.place)];
  auto ball = [&](int j) { return detail::is_undriven_ball(model.joints()[at(j)]); };
  return !island.augmented && island.strings.empty() &&
         *std::max_element(arms.begin(), arms.end()) <= detail::kMaxArms &&
         std::all_of(island.parts.begin(), island.parts.end(), rigid) &&
         std::all_of(island.joints.begin(), island.joints.end(), ball);
}

PLIANT_INLINE RigidIsland::RigidIsland(const Model& model, const Island& island)
    : island_(static_cast<int>(&island - model.islands().data())) {
  // Parts are sorted by their number of joints, so that four parts that are evaluated together have similar
  // numbers of joints.
  std::vector<std::vector<int>> joints_of(island.parts.size());
  for (const int j : island.joints)
    for (const JointSide& side : model.joints()[at(j)].sides) joints_of[at(side.place)].push_back(j);
  std::vector<int> order(island.parts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return joints_of[at(a)].size() > joints_of[at(b)].size(); });
  std::vector<std::array<End, 2>> ends(island.joints.size());
  for (std::size_t first = 0; first < order.size(); first += Pack::kLanes)
    add_four(model, island, order, first, joints_of, ends);
  add_joints(model, island, ends);
}

PLIANT_INLINE void RigidIsland::add_four(const Model& model, const Island& island,
                                         const std::vector<int>& order, std::size_t first,
                                         const std::vector<std::vector<int>>& joints_of,
                                         std::vector<std::array<End, 2>>& ends) {
  Four four;
  four.count = static_cast<int>(std::min<std::size_t>(Pack::kLanes, order.size() - first));
  four.first_arm = static_cast<int>(arms_.size());
  four.arms = static_cast<int>(joints_of[at(order[first])].size());
  four.first_pair = pairs_;
  pairs_ += four.arms * (four.arms + 1) / 2;
  arms_.resize(arms_.size() + at(four.arms),
               {Mat3<Pack>::Constant(Pack(0.0)), Vec3<Pack>::Constant(Pack(0.0))});
  for (int lane = 0; lane < Pack::kLanes; ++lane) {
    const int place = order[std::min(first + at(lane), order.size() - 1)], i = island.parts[at(place)];
    const PartModel& m = model.parts()[at(i)];
    four.q0[at(lane)] = m.q0;
    four.v0[at(lane)] = m.v0;
    const Inertia<double>& rest = m.part->rest_inertia();
    const Vec3<double> centre = rest.moment / rest.mass;
    const Mat3<double> inertia = rest.M.bottomRightCorner<3, 3>() + rest.mass * skew(centre) * skew(centre);
    const Mat3<double> L = Mat3<double>(inertia.llt().matrixU()).inverse();
    four.inverse_mass.set(lane, 1 / rest.mass);
    detail::set_lane(four.inertia, lane, inertia);
    detail::set_lane(four.L, lane, L);
    detail::set_lane(four.centre, lane, centre);
    if (lane >= four.count) continue;
    if (m.loaded) loads_.push_back({i, static_cast<int>(fours_.size()), lane});
    for (std::size_t k = 0; k < joints_of[at(place)].size(); ++k) {
      const JointModel& joint = model.joints()[at(joints_of[at(place)][k])];
      const std::size_t end = joint.at[0].part == i ? 0 : 1;
      const int arm = four.first_arm + static_cast<int>(k);
      ends[at(joint.node)][end] = {arm, lane, m.q0, m.v0};
      const Vec3<double> r = m.rigid_ports[at(joint.at[end].port)].p - centre;
      detail::set_lane(arms_[at(arm)].r, lane, r);
      detail::set_lane(arms_[at(arm)].lever, lane, skew(r) * L);
    }
  }
  fours_.push_back(four);
}

PLIANT_INLINE void RigidIsland::add_joints(const Model& model, const Island& island,
                                           const std::vector<std::array<End, 2>>& ends) {
  rows_ = island.rows;
  parts_ = static_cast<int>(island.parts.size());
  const auto& joints = model.joints();
  for (const int j : island.joints)
    joints_.push_back({ends[at(joints[at(j)].node)], detail::fixed_end(model, joints[at(j)]),
                       joints[at(j)].island_row, joints[at(j)].length});
  for (const pliant::Coupling& c : island.couplings) {
    auto end_of = [&](int j) { return joints[at(j)].at[0].part == c.part ? 0u : 1u; };
    const End &row = ends[at(joints[at(c.row_joint)].node)][end_of(c.row_joint)],
              &column = ends[at(joints[at(c.column_joint)].node)][end_of(c.column_joint)];
    const auto four = std::upper_bound(fours_.begin(), fours_.end(), row.arm,
                                       [](int arm, const Four& f) { return arm < f.first_arm; }) -
                      1;
    const int i = std::min(row.arm, column.arm) - four->first_arm,
              j = std::max(row.arm, column.arm) - four->first_arm;
    couplings_.push_back({four->first_pair + i * four->arms - i * (i - 1) / 2 + j - i, row.lane,
                          row.arm > column.arm, end_of(c.row_joint) == end_of(c.column_joint) ? 1.0 : -1.0,
                          c.target});
  }
}

PLIANT_INLINE void RigidIsland::accelerate(const Model& model, const VecX<double>& q, const VecX<double>& v,
                                           const Vec3<double>& gravity, Workspace<double>& work,
                                           RigidWorkspace& now) const {
  now.fours.resize(fours_.size());
  now.arms.resize(arms_.size());
  now.mobility.resize(at(pairs_));
  for (std::size_t i = 0; i < fours_.size(); ++i)
    place(fours_[i], q, v, gravity.cast<Pack>(), now, now.fours[i]);
  now.counters.inertial_forces += parts_;
  add_loads(work, now);
  JointFactor<double>& W_c = work.joints.W_c[at(island_)];
  factor(model.islands()[at(island_)], work.joints.rank, now, W_c.blocks());
  const int refinements = W_c.is_rough() || model.islands()[at(island_)].uneven ? 2 : 0;
  for (int pass = 0; pass <= refinements; ++pass) apply_joints(W_c.blocks(), now);
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& constants = fours_[i];
    const RigidWorkspace::Four& four = now.fours[i];
    const Vec3<Pack> omega_dot = constants.L.lazyProduct(four.beta);
    const Vec3<Pack> centripetal = four.omega.cross(four.omega.cross(constants.centre));
    const Vec3<Pack> c_ddot = four.a - four.R.lazyProduct(omega_dot.cross(constants.centre) + centripetal);
    for (int lane = 0; lane < constants.count; ++lane)
      for (int k = 0; k < 3; ++k) {
        work.v_dot[constants.v0[at(lane)] + k] = c_ddot[k][lane];
        work.v_dot[constants.v0[at(lane)] + 3 + k] = omega_dot[k][lane];
      }
  }
}

PLIANT_INLINE Vec3<double> RigidIsland::mass_moment(const VecX<double>& q, const RigidWorkspace& now) const {
  Vec3<double> moment = Vec3<double>::Zero();
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& constants = fours_[i];
    const Vec3<Pack> centre = now.fours[i].R.lazyProduct(constants.centre);
    for (int lane = 0; lane < constants.count; ++lane)
      for (int k = 0; k < 3; ++k)
        moment[k] += (q[constants.q0[at(lane)] + k] + centre[k][lane]) / constants.inverse_mass[lane];
  }
  return moment;
}

[[gnu::flatten]] PLIANT_INLINE void RigidIsland::place(const Four& constants, const VecX<double>& q,
                                                       const VecX<double>& v, const Vec3<Pack>& gravity,
                                                       RigidWorkspace& now,
                                                       RigidWorkspace::Four& four) const {
  four.R = rotation(detail::gather_lanes(q, constants.q0, 3), detail::gather_lanes(q, constants.q0, 4),
                    detail::gather_lanes(q, constants.q0, 5), detail::gather_lanes(q, constants.q0, 6));
  four.omega = detail::gather_lanes3(v, constants.v0, 3);
  four.a = gravity;
  // g_q of Eq. (11) for a rigid part: the torque -omega x (I omega)
  four.beta =
      -constants.L.transpose().lazyProduct(four.omega.cross(constants.inertia.lazyProduct(four.omega)));
  for (int i = 0; i < constants.arms; ++i) {
    const Arm& arm = arms_[at(constants.first_arm + i)];
    RigidWorkspace::Arm& moved = now.arms[at(constants.first_arm + i)];
    moved.B = four.R.lazyProduct(arm.lever);
    moved.centripetal = four.R.lazyProduct(four.omega.cross(four.omega.cross(arm.r)));
  }
  couple(constants, now);
}

[[gnu::flatten]] PLIANT_INLINE void RigidIsland::couple(const Four& constants, RigidWorkspace& now) {
  auto pair = now.mobility.begin() + constants.first_pair;
  for (int i = 0; i < constants.arms; ++i)
    for (int j = i; j < constants.arms; ++j, ++pair) {
      *pair = now.arms[at(constants.first_arm + i)].B.lazyProduct(
          now.arms[at(constants.first_arm + j)].B.transpose());
      for (int k = 0; k < 3; ++k) (*pair)(k, k) += constants.inverse_mass;
    }
}

PLIANT_INLINE void RigidIsland::add_loads(const Workspace<double>& work, RigidWorkspace& now) const {
  for (const Load& load : loads_) {
    const VecX<double>& f = work.parts[at(load.part)].f;
    const Four& constants = fours_[at(load.four)];
    RigidWorkspace::Four& four = now.fours[at(load.four)];
    const Vec3<double> force = f.head<3>();
    const Vec3<double> torque = f.segment<3>(3) - detail::lane_of(constants.centre, load.lane).cross(force);
    detail::set_lane(four.a, load.lane,
                     detail::lane_of(four.a, load.lane) +
                         detail::lane_of(four.R, load.lane) * force * constants.inverse_mass[load.lane]);
    detail::set_lane(
        four.beta, load.lane,
        detail::lane_of(four.beta, load.lane) + detail::lane_of(constants.L, load.lane).transpose() * torque);
  }
}

PLIANT_INLINE void RigidIsland::factor(const Island& island, RankRule rank, const RigidWorkspace& now,
                                       BlockFactor<double>& W_c) const {
  W_c.clear(island.pattern, rank);
  for (const Coupling& c : couplings_) {
    const Mat3<Pack>& mobility = now.mobility[at(c.pair)];
    double* block = W_c.block(c.target);
    for (Eigen::Index k = 0; k < 3; ++k)
      for (Eigen::Index r = 0; r < 3; ++r)
        block[k * 3 + r] += c.sign * (c.transposed ? mobility(k, r) : mobility(r, k))[c.lane];
  }
  W_c.factor();
}

[[gnu::flatten]] PLIANT_INLINE void RigidIsland::apply_joints(const BlockFactor<double>& W_c,
                                                              RigidWorkspace& now) const {
  for (std::size_t i = 0; i < fours_.size(); ++i)
    for (int k = 0; k < fours_[i].arms; ++k) {
      RigidWorkspace::Arm& arm = now.arms[at(fours_[i].first_arm + k)];
      arm.x = now.fours[i].a - arm.B.lazyProduct(now.fours[i].beta) + arm.centripetal;
    }
  now.lambda.setZero(rows_);
  for_each_end([&](const End& end, int row, double sign) {
    for (int r = 0; r < 3; ++r) now.lambda[row + r] += sign * now.arms[at(end.arm)].x[r][end.lane];
  });
  solve_forces(W_c, now);
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const auto [a, beta] = response(fours_[i], now);
    now.fours[i].a += a;
    now.fours[i].beta += beta;
  }
}

[[gnu::flatten]] PLIANT_INLINE void RigidIsland::solve_forces(const BlockFactor<double>& W_c,
                                                              RigidWorkspace& now) const {
  W_c.solve(now.lambda);
  for (RigidWorkspace::Arm& arm : now.arms) arm.push.setConstant(Pack(0.0));
  for_each_end([&](const End& end, int row, double sign) {
    for (int r = 0; r < 3; ++r) now.arms[at(end.arm)].push[r].set(end.lane, -sign * now.lambda[row + r]);
  });
}

[[gnu::flatten]] PLIANT_INLINE std::pair<Vec3<Pack>, Vec3<Pack>> RigidIsland::response(
    const Four& constants, const RigidWorkspace& now) const {
  Vec3<Pack> a = Vec3<Pack>::Constant(Pack(0.0)), beta = a;
  for (int k = 0; k < constants.arms; ++k) {
    const RigidWorkspace::Arm& arm = now.arms[at(constants.first_arm + k)];
    a += arm.push * constants.inverse_mass;
    beta -= arm.B.transpose().lazyProduct(arm.push);
  }
  return {a, beta};
}

PLIANT_INLINE double RigidIsland::largest_gap(const Rounding& allowed, bool positions, const VecX<double>& x,
                                              RigidWorkspace& now) const {
  now.lambda.resize(rows_);
  double largest = 0;
  for (const BallJoint& joint : joints_) {
    Vec3<double> C = positions ? joint.fixed : Vec3<double>(Vec3<double>::Zero());
    double size = 0, sign = 1;
    for (const End& end : joint.ends) {
      if (end.arm >= 0) {
        for (int r = 0; r < 3; ++r) C[r] += sign * now.arms[at(end.arm)].x[r][end.lane];
        size = std::max(size, x.segment<3>(positions ? end.q0 : end.v0).lpNorm<Eigen::Infinity>());
        if (!positions) {
          const double reach =
              joint.length + detail::lane_of(arms_[at(end.arm)].r, end.lane).lpNorm<Eigen::Infinity>();
          size = std::max(size, reach * x.segment<3>(end.v0 + 3).lpNorm<Eigen::Infinity>());
        }
      }
      sign = -1;
    }
    now.lambda.segment<3>(joint.row) = C;
    const double rounding =
        allowed.per_length * (positions ? 1 : allowed.rate) * joint.length + allowed.per_size * size;
    const double ratio = C.norm() / rounding;
    if (!(ratio <= largest)) largest = ratio;  // NaN becomes the largest
  }
  return largest;
}

template <bool with_rotation>
[[gnu::flatten]] void RigidIsland::place_arms(const VecX<double>& q, RigidWorkspace& now) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& constants = fours_[i];
    const Mat3<Pack> R =
        rotation(detail::gather_lanes(q, constants.q0, 3), detail::gather_lanes(q, constants.q0, 4),
                 detail::gather_lanes(q, constants.q0, 5), detail::gather_lanes(q, constants.q0, 6));
    if constexpr (with_rotation) now.fours[i].R = R;
    const Vec3<Pack> c = detail::gather_lanes3(q, constants.q0, 0);
    for (int k = 0; k < constants.arms; ++k) {
      const Arm& arm = arms_[at(constants.first_arm + k)];
      RigidWorkspace::Arm& placed = now.arms[at(constants.first_arm + k)];
      if constexpr (with_rotation) placed.B = R.lazyProduct(arm.lever);
      placed.x = c + R.lazyProduct(arm.r + constants.centre);
    }
  }
}

[[gnu::flatten]] PLIANT_INLINE void RigidIsland::set_arm_velocities(const VecX<double>& v,
                                                                    RigidWorkspace& now) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& constants = fours_[i];
    const Vec3<Pack> c_dot = detail::gather_lanes3(v, constants.v0, 0),
                     omega = detail::gather_lanes3(v, constants.v0, 3);
    for (int k = 0; k < constants.arms; ++k) {
      const Vec3<Pack> p = arms_[at(constants.first_arm + k)].r + constants.centre;
      now.arms[at(constants.first_arm + k)].x = c_dot + now.fours[i].R.lazyProduct(omega.cross(p));
    }
  }
}

[[gnu::flatten]] PLIANT_INLINE void RigidIsland::displace(const RigidWorkspace& now, VecX<double>& q) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& constants = fours_[i];
    const auto [shift, beta] = response(constants, now);
    const Vec3<Pack> turn = constants.L.lazyProduct(beta);
    const Vec3<Pack> c = detail::gather_lanes3(q, constants.q0, 0) + shift -
                         now.fours[i].R.lazyProduct(turn.cross(constants.centre));
    for (int lane = 0; lane < constants.count; ++lane) {
      auto theta = q.segment<4>(constants.q0[at(lane)] + 3);
      const Eigen::Quaterniond half(1, 0.5 * turn[0][lane], 0.5 * turn[1][lane], 0.5 * turn[2][lane]);
      const Eigen::Quaterniond turned =
          (Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]) * half).normalized();
      theta << turned.w(), turned.x(), turned.y(), turned.z();
      for (int r = 0; r < 3; ++r) q[constants.q0[at(lane)] + r] = c[r][lane];
    }
  }
}

[[gnu::flatten]] PLIANT_INLINE void RigidIsland::change_velocities(const RigidWorkspace& now, double time,
                                                                   VecX<double>& v) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& constants = fours_[i];
    const auto [push, beta] = response(constants, now);
    const Vec3<Pack> spin = constants.L.lazyProduct(beta);
    const Vec3<Pack> shift = push - now.fours[i].R.lazyProduct(spin.cross(constants.centre));
    for (int lane = 0; lane < constants.count; ++lane)
      for (int r = 0; r < 3; ++r) {
        v[constants.v0[at(lane)] + r] += time * shift[r][lane];
        v[constants.v0[at(lane)] + 3 + r] += time * spin[r][lane];
      }
  }
}

template <class F>
void RigidIsland::for_each_part(F&& act) const {
  Eigen::Index part = 0;
  for (const Four& constants : fours_)
    for (std::size_t lane = 0; lane < at(constants.count); ++lane, ++part)
      act(part, constants.q0[lane], constants.v0[lane]);
}

namespace detail {

/// Largest number of iterations that close joints, and the ratio of two successive gaps above which an
/// iteration is slow.
inline constexpr int kMaxClosingIterations = 8;
inline constexpr double kSlowClosing = 0.5;
/// Number of iterations that cost as much as a new factor. A new factor is computed if the joints would still
/// be open after this number of further iterations.
inline constexpr int kIterationsPerFactor = 2;

/// Iterates until the joints are closed. measure() returns the largest gap divided by the allowed gap.
/// correct(gap, ratio) does one iteration; ratio: this gap divided by the previous gap, 0 in the first
/// iteration. Returns false if correct() returns false, if a gap is not finite, or after
/// kMaxClosingIterations.
template <class Measure, class Correct>
bool iterate_closing(Measure&& measure, Correct&& correct) {
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kMaxClosingIterations; ++i) {
    const double now = measure();
    if (now <= 1) return true;
    if (!std::isfinite(now) || !correct(now, now / before)) return false;
    before = now;
  }
  return false;
}

}  // namespace detail

PLIANT_INLINE bool RigidIsland::close(const Island& island, const Rounding& allowed, BlockFactor<double>& W_c,
                                      RigidWorkspace& now, VecX<double>& q, VecX<double>& v) const {
  now.q_before.resize(7, parts_);
  now.v_before.resize(6, parts_);
  for_each_part([&](Eigen::Index k, int q0, int v0) {
    now.q_before.col(k) = q.segment<7>(q0);
    now.v_before.col(k) = v.segment<6>(v0);
  });
  bool fresh = false;
  auto find_forces = [&](double gap, double ratio) {
    if (ratio > detail::kSlowClosing && fresh) return false;
    if (!fresh && gap * std::pow(ratio, detail::kIterationsPerFactor) > 1) {
      for (const Four& constants : fours_) couple(constants, now);
      factor(island, RankRule::keep, now, W_c);
      fresh = true;
    }
    solve_forces(W_c, now);
    return true;
  };
  auto gap = [&] {
    place_arms<true>(q, now);
    return largest_gap(allowed, true, q, now);
  };
  auto correct = [&](double left, double ratio) {
    if (!find_forces(left, ratio)) return false;
    displace(now, q);
    return true;
  };
  auto rate = [&] {
    set_arm_velocities(v, now);
    return largest_gap(allowed, false, v, now);
  };
  auto correct_rates = [&](double left, double ratio) {
    if (!find_forces(left, ratio)) return false;
    change_velocities(now, 1, v);
    return true;
  };
  if (detail::iterate_closing(gap, correct) && detail::iterate_closing(rate, correct_rates)) return true;
  for_each_part([&](Eigen::Index k, int q0, int v0) {
    q.segment<7>(q0) = now.q_before.col(k);
    v.segment<6>(v0) = now.v_before.col(k);
  });
  return false;
}

PLIANT_INLINE bool RigidIsland::close_ahead(const Rounding& allowed, double h, const BlockFactor<double>& W_c,
                                            RigidWorkspace& now, VecX<double>& v,
                                            const std::function<const VecX<double>&()>& q_end) const {
  now.v_before.resize(6, parts_);
  for_each_part([&](Eigen::Index k, int, int v0) { now.v_before.col(k) = v.segment<6>(v0); });
  auto gap = [&] {
    const VecX<double>& q = q_end();
    place_arms<false>(q, now);
    return largest_gap(allowed, true, q, now);
  };
  auto correct = [&](double, double ratio) {
    if (ratio > detail::kSlowClosing) return false;
    solve_forces(W_c, now);
    change_velocities(now, 1 / h, v);
    return true;
  };
  if (detail::iterate_closing(gap, correct)) return true;
  for_each_part([&](Eigen::Index k, int, int v0) { v.segment<6>(v0) = now.v_before.col(k); });
  return false;
}

}  // namespace pliant
