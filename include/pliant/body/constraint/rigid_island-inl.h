#include <pliant/body/constraint/rigid_island.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <pliant/body/dynamics.h>
#include <pliant/body/joints/ball.h>
#include <pliant/math/index.h>
#include <pliant/math/rotation.h>

namespace pliant {

namespace {

/// Most joints of a part: all pairs of them are taken for four parts at once.
constexpr int kMostArms = 16;

bool is_fixed_ball(const JointModel& m) {
  if (dynamic_cast<const JointOf<Ball>*>(m.joint) == nullptr || m.driven) return false;
  return m.at[0].part != m.at[1].part;
}

/// What the end of a joint that does not move adds to C = x_0 - x_1.
Vec3<double> fixed_end(const Model& model, const JointModel& joint) {
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

/// Number k from `first` on of each of four parts.
Pack gather(const VecX<double>& of, const std::array<int, Pack::kLanes>& first, int k) {
  return {of[first[0] + k], of[first[1] + k], of[first[2] + k], of[first[3] + k]};
}
Vec3<Pack> gather3(const VecX<double>& of, const std::array<int, Pack::kLanes>& first, int k) {
  return {gather(of, first, k), gather(of, first, k + 1), gather(of, first, k + 2)};
}

template <class M>
using Lane = Eigen::Matrix<double, M::RowsAtCompileTime, M::ColsAtCompileTime>;
template <class M>
Lane<M> lane_of(const M& of, int lane) {
  Lane<M> one;
  for (Eigen::Index i = 0; i < of.size(); ++i) one.data()[i] = of.data()[i][lane];
  return one;
}
template <class M>
void set_lane(M& of, int lane, const Lane<M>& value) {
  for (Eigen::Index i = 0; i < of.size(); ++i) of.data()[i].set(lane, value.data()[i]);
}

}  // namespace

bool RigidIsland::takes(const Model& model, const Island& island) {
  auto rigid = [&](int i) {
    const PartModel& m = model.parts()[at(i)];
    return m.n_s == 0 && m.local == nullptr && m.drag == 0 && !m.rigid_factor.any_held();
  };
  std::vector<int> arms(island.parts.size(), 0);
  for (const int j : island.joints)
    for (const JointSide& side : model.joints()[at(j)].sides) ++arms[at(side.place)];
  auto ball = [&](int j) { return is_fixed_ball(model.joints()[at(j)]); };
  return !island.augmented && island.strings.empty() &&
         *std::max_element(arms.begin(), arms.end()) <= kMostArms &&
         std::all_of(island.parts.begin(), island.parts.end(), rigid) &&
         std::all_of(island.joints.begin(), island.joints.end(), ball);
}

RigidIsland::RigidIsland(const Model& model, const Island& island)
    : island_(static_cast<int>(&island - model.islands().data())) {
  // The joints of each part, and its parts, those of as many joints together.
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

void RigidIsland::add_four(const Model& model, const Island& island, const std::vector<int>& order,
                           std::size_t first, const std::vector<std::vector<int>>& joints_of,
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
    set_lane(four.inertia, lane, inertia);
    set_lane(four.L, lane, L);
    set_lane(four.centre, lane, centre);
    if (lane >= four.count) continue;
    if (m.loaded) loads_.push_back({i, static_cast<int>(fours_.size()), lane});
    for (std::size_t k = 0; k < joints_of[at(place)].size(); ++k) {
      const JointModel& joint = model.joints()[at(joints_of[at(place)][k])];
      const std::size_t end = joint.at[0].part == i ? 0 : 1;
      const int arm = four.first_arm + static_cast<int>(k);
      ends[at(joint.node)][end] = {arm, lane, m.q0, m.v0};
      const Vec3<double> r = m.rigid_ports[at(joint.at[end].port)].p - centre;
      set_lane(arms_[at(arm)].r, lane, r);
      set_lane(arms_[at(arm)].lever, lane, skew(r) * L);
    }
  }
  fours_.push_back(four);
}

void RigidIsland::add_joints(const Model& model, const Island& island,
                             const std::vector<std::array<End, 2>>& ends) {
  rows_ = island.rows;
  parts_ = static_cast<int>(island.parts.size());
  const auto& joints = model.joints();
  for (const int j : island.joints)
    ties_.push_back({ends[at(joints[at(j)].node)], fixed_end(model, joints[at(j)]), joints[at(j)].island_row,
                     joints[at(j)].length});
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

void RigidIsland::accelerate(const Model& model, const VecX<double>& q, const VecX<double>& v,
                             const Vec3<double>& gravity, RankRule rank, Workspace<double>& work,
                             RigidWorkspace& now) const {
  now.fours.resize(fours_.size());
  now.arms.resize(arms_.size());
  now.mobility.resize(at(pairs_));
  for (std::size_t i = 0; i < fours_.size(); ++i)
    place(fours_[i], q, v, gravity.cast<Pack>(), now, now.fours[i]);
  now.counters.inertial_forces += parts_;
  add_loads(work, now);
  JointFactor<double>& W_c = work.joints.W_c[at(island_)];
  factor(model.islands()[at(island_)], rank, now, W_c.blocks());
  const int refinements = W_c.is_rough() || model.islands()[at(island_)].uneven ? 2 : 0;
  for (int pass = 0; pass <= refinements; ++pass) hold(W_c.blocks(), now);
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& of = fours_[i];
    const RigidWorkspace::Four& four = now.fours[i];
    const Vec3<Pack> omega_dot = of.L.lazyProduct(four.beta);
    const Vec3<Pack> swing = four.omega.cross(four.omega.cross(of.centre));
    const Vec3<Pack> c_ddot = four.a - four.R.lazyProduct(omega_dot.cross(of.centre) + swing);
    for (int lane = 0; lane < of.count; ++lane)
      for (int k = 0; k < 3; ++k) {
        work.v_dot[of.v0[at(lane)] + k] = c_ddot[k][lane];
        work.v_dot[of.v0[at(lane)] + 3 + k] = omega_dot[k][lane];
      }
  }
}

[[gnu::flatten]] void RigidIsland::place(const Four& of, const VecX<double>& q, const VecX<double>& v,
                                         const Vec3<Pack>& gravity, RigidWorkspace& now,
                                         RigidWorkspace::Four& four) const {
  four.R = rotation(gather(q, of.q0, 3), gather(q, of.q0, 4), gather(q, of.q0, 5), gather(q, of.q0, 6));
  four.omega = gather3(v, of.v0, 3);
  four.a = gravity;
  four.beta = -of.L.transpose().lazyProduct(four.omega.cross(of.inertia.lazyProduct(four.omega)));
  for (int i = 0; i < of.arms; ++i) {
    const Arm& arm = arms_[at(of.first_arm + i)];
    RigidWorkspace::Arm& moved = now.arms[at(of.first_arm + i)];
    moved.B = four.R.lazyProduct(arm.lever);
    moved.swing = four.R.lazyProduct(four.omega.cross(four.omega.cross(arm.r)));
  }
  couple(of, now);
}

[[gnu::flatten]] void RigidIsland::couple(const Four& of, RigidWorkspace& now) {
  auto pair = now.mobility.begin() + of.first_pair;
  for (int i = 0; i < of.arms; ++i)
    for (int j = i; j < of.arms; ++j, ++pair) {
      *pair = now.arms[at(of.first_arm + i)].B.lazyProduct(now.arms[at(of.first_arm + j)].B.transpose());
      for (int k = 0; k < 3; ++k) (*pair)(k, k) += of.inverse_mass;
    }
}

void RigidIsland::add_loads(const Workspace<double>& work, RigidWorkspace& now) const {
  for (const Load& load : loads_) {
    const VecX<double>& f = work.parts[at(load.part)].f;
    const Four& of = fours_[at(load.four)];
    RigidWorkspace::Four& four = now.fours[at(load.four)];
    const Vec3<double> force = f.head<3>();
    const Vec3<double> torque = f.segment<3>(3) - lane_of(of.centre, load.lane).cross(force);
    set_lane(four.a, load.lane,
             lane_of(four.a, load.lane) + lane_of(four.R, load.lane) * force * of.inverse_mass[load.lane]);
    set_lane(four.beta, load.lane,
             lane_of(four.beta, load.lane) + lane_of(of.L, load.lane).transpose() * torque);
  }
}

void RigidIsland::factor(const Island& island, RankRule rank, const RigidWorkspace& now,
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

[[gnu::flatten]] void RigidIsland::hold(const BlockFactor<double>& W_c, RigidWorkspace& now) const {
  for (std::size_t i = 0; i < fours_.size(); ++i)
    for (int k = 0; k < fours_[i].arms; ++k) {
      RigidWorkspace::Arm& arm = now.arms[at(fours_[i].first_arm + k)];
      arm.x = now.fours[i].a - arm.B.lazyProduct(now.fours[i].beta) + arm.swing;
    }
  now.lambda.setZero(rows_);
  for_each_end([&](const End& end, int row, double sign) {
    for (int r = 0; r < 3; ++r) now.lambda[row + r] += sign * now.arms[at(end.arm)].x[r][end.lane];
  });
  take_forces(W_c, now);
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const auto [a, beta] = response(fours_[i], now);
    now.fours[i].a += a;
    now.fours[i].beta += beta;
  }
}

[[gnu::flatten]] void RigidIsland::take_forces(const BlockFactor<double>& W_c, RigidWorkspace& now) const {
  W_c.solve(now.lambda);
  for (RigidWorkspace::Arm& arm : now.arms) arm.push.setConstant(Pack(0.0));
  for_each_end([&](const End& end, int row, double sign) {
    for (int r = 0; r < 3; ++r) now.arms[at(end.arm)].push[r].set(end.lane, -sign * now.lambda[row + r]);
  });
}

[[gnu::flatten]] std::pair<Vec3<Pack>, Vec3<Pack>> RigidIsland::response(const Four& of,
                                                                         const RigidWorkspace& now) const {
  Vec3<Pack> a = Vec3<Pack>::Constant(Pack(0.0)), beta = a;
  for (int k = 0; k < of.arms; ++k) {
    const RigidWorkspace::Arm& arm = now.arms[at(of.first_arm + k)];
    a += arm.push * of.inverse_mass;
    beta -= arm.B.transpose().lazyProduct(arm.push);
  }
  return {a, beta};
}

double RigidIsland::widest(const Rounding& most, bool positions, const VecX<double>& x,
                           RigidWorkspace& now) const {
  now.lambda.resize(rows_);
  double widest = 0;
  for (const Tie& tie : ties_) {
    Vec3<double> C = positions ? tie.fixed : Vec3<double>(Vec3<double>::Zero());
    double size = 0, sign = 1;
    for (const End& end : tie.ends) {
      if (end.arm >= 0) {
        for (int r = 0; r < 3; ++r) C[r] += sign * now.arms[at(end.arm)].x[r][end.lane];
        size = std::max(size, positions ? x.segment<3>(end.q0).lpNorm<Eigen::Infinity>()
                                        : x.segment<6>(end.v0).lpNorm<Eigen::Infinity>());
      }
      sign = -1;
    }
    now.lambda.segment<3>(tie.row) = C;
    const double rounding = most.of_length * (positions ? 1 : most.rate) * tie.length + most.of_size * size;
    const double share = C.norm() / rounding;
    if (!(share <= widest)) widest = share;
  }
  return widest;
}

template <bool turned>
[[gnu::flatten]] void RigidIsland::place_arms(const VecX<double>& q, RigidWorkspace& now) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& of = fours_[i];
    const Mat3<Pack> R =
        rotation(gather(q, of.q0, 3), gather(q, of.q0, 4), gather(q, of.q0, 5), gather(q, of.q0, 6));
    if constexpr (turned) now.fours[i].R = R;
    const Vec3<Pack> c = gather3(q, of.q0, 0);
    for (int k = 0; k < of.arms; ++k) {
      const Arm& arm = arms_[at(of.first_arm + k)];
      RigidWorkspace::Arm& placed = now.arms[at(of.first_arm + k)];
      if constexpr (turned) placed.B = R.lazyProduct(arm.lever);
      placed.x = c + R.lazyProduct(arm.r + of.centre);
    }
  }
}

[[gnu::flatten]] void RigidIsland::move_arms(const VecX<double>& v, RigidWorkspace& now) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& of = fours_[i];
    const Vec3<Pack> c_dot = gather3(v, of.v0, 0), omega = gather3(v, of.v0, 3);
    for (int k = 0; k < of.arms; ++k) {
      const Vec3<Pack> p = arms_[at(of.first_arm + k)].r + of.centre;
      now.arms[at(of.first_arm + k)].x = c_dot + now.fours[i].R.lazyProduct(omega.cross(p));
    }
  }
}

[[gnu::flatten]] void RigidIsland::shift(const RigidWorkspace& now, VecX<double>& q) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& of = fours_[i];
    const auto [shift, beta] = response(of, now);
    const Vec3<Pack> turn = of.L.lazyProduct(beta);
    const Vec3<Pack> c = gather3(q, of.q0, 0) + shift - now.fours[i].R.lazyProduct(turn.cross(of.centre));
    for (int lane = 0; lane < of.count; ++lane) {
      auto theta = q.segment<4>(of.q0[at(lane)] + 3);
      const Eigen::Quaterniond half(1, 0.5 * turn[0][lane], 0.5 * turn[1][lane], 0.5 * turn[2][lane]);
      const Eigen::Quaterniond turned =
          (Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]) * half).normalized();
      theta << turned.w(), turned.x(), turned.y(), turned.z();
      for (int r = 0; r < 3; ++r) q[of.q0[at(lane)] + r] = c[r][lane];
    }
  }
}

[[gnu::flatten]] void RigidIsland::push(const RigidWorkspace& now, double time, VecX<double>& v) const {
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& of = fours_[i];
    const auto [push, beta] = response(of, now);
    const Vec3<Pack> spin = of.L.lazyProduct(beta);
    const Vec3<Pack> shift = push - now.fours[i].R.lazyProduct(spin.cross(of.centre));
    for (int lane = 0; lane < of.count; ++lane)
      for (int r = 0; r < 3; ++r) {
        v[of.v0[at(lane)] + r] += time * shift[r][lane];
        v[of.v0[at(lane)] + 3 + r] += time * spin[r][lane];
      }
  }
}

template <class F>
void RigidIsland::for_each_part(F&& act) const {
  Eigen::Index part = 0;
  for (const Four& of : fours_)
    for (std::size_t lane = 0; lane < at(of.count); ++lane, ++part) act(part, of.q0[lane], of.v0[lane]);
}

namespace {

/// Most iterations that close joints, and what each is to leave of the gaps at most.
constexpr int kMostIterations = 8;
constexpr double kSlow = 0.5;
/// Iterations that cost as much as a new factor.
constexpr int kFactor = 2;

/// measure(): the widest gap, in what it may be; correct(gap, share): one iteration, where the one before has
/// left that share of the gap (0: the first). correct is false where it gives up.
template <class Measure, class Correct>
bool iterate(Measure&& measure, Correct&& correct) {
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kMostIterations; ++i) {
    const double now = measure();
    if (now <= 1) return true;
    if (!std::isfinite(now) || !correct(now, now / before)) return false;
    before = now;
  }
  return false;
}

}  // namespace

bool RigidIsland::close(const Island& island, const Rounding& most, BlockFactor<double>& W_c,
                        RigidWorkspace& now, VecX<double>& q, VecX<double>& v) const {
  now.q_before.resize(7, parts_);
  now.v_before.resize(6, parts_);
  for_each_part([&](Eigen::Index k, int q0, int v0) {
    now.q_before.col(k) = q.segment<7>(q0);
    now.v_before.col(k) = v.segment<6>(v0);
  });
  bool fresh = false;
  auto find_forces = [&](double gap, double share) {
    if (share > kSlow && fresh) return false;
    if (!fresh && gap * std::pow(share, kFactor) > 1) {
      for (const Four& of : fours_) couple(of, now);
      factor(island, RankRule::keep, now, W_c);
      fresh = true;
    }
    take_forces(W_c, now);
    return true;
  };
  auto gap = [&] {
    place_arms<true>(q, now);
    return widest(most, true, q, now);
  };
  auto correct = [&](double left, double share) {
    if (!find_forces(left, share)) return false;
    shift(now, q);
    return true;
  };
  auto rate = [&] {
    move_arms(v, now);
    return widest(most, false, v, now);
  };
  auto correct_rates = [&](double left, double share) {
    if (!find_forces(left, share)) return false;
    push(now, 1, v);
    return true;
  };
  if (iterate(gap, correct) && iterate(rate, correct_rates)) return true;
  for_each_part([&](Eigen::Index k, int q0, int v0) {
    q.segment<7>(q0) = now.q_before.col(k);
    v.segment<6>(v0) = now.v_before.col(k);
  });
  return false;
}

bool RigidIsland::close_ahead(const Rounding& most, double h, const BlockFactor<double>& W_c,
                              RigidWorkspace& now, VecX<double>& v,
                              const std::function<const VecX<double>&()>& q_end) const {
  now.v_before.resize(6, parts_);
  for_each_part([&](Eigen::Index k, int, int v0) { now.v_before.col(k) = v.segment<6>(v0); });
  auto gap = [&] {
    const VecX<double>& q = q_end();
    place_arms<false>(q, now);
    return widest(most, true, q, now);
  };
  auto correct = [&](double, double share) {
    if (share > kSlow) return false;
    take_forces(W_c, now);
    push(now, 1 / h, v);
    return true;
  };
  if (iterate(gap, correct)) return true;
  for_each_part([&](Eigen::Index k, int, int v0) { v.segment<6>(v0) = now.v_before.col(k); });
  return false;
}

}  // namespace pliant
