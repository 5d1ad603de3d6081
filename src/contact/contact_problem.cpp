#include <pliant/contact/contact_problem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>

#include <pliant/body/group.h>
#include <pliant/contact/node_motion.h>

namespace pliant {

namespace {

/// Sweeps end when impulses change velocities by less than this, relative to what there is to stop; or by so
/// many units of rounding of the velocities themselves.
constexpr double kExact = 1e-13, kUlps = 8;
/// The same where nodes are pushed, many at a time and lightly coupled.
constexpr double kExactOfNodes = 1e-6;
constexpr int kMostNewton = 20;
/// Of these, in a row, that may make nothing better in clusters of more blocks than this, where they are
/// dear.
constexpr int kMostFutile = 4;
constexpr std::size_t kDear = 30;
/// Rounds of so many sweeps, which are extrapolated from so many before them.
constexpr std::array<std::pair<int, int>, 4> kRounds{{{12, 4}, {120, 8}, {400, 0}, {200, 8}}};
constexpr std::size_t kRoundsOfNodes = 2;
/// Most blocks that are solved as one system.
constexpr std::size_t kMostDense = 100, kMostDenseOfNodes = 12;
/// Extrapolation starts anew when it has made things worse by this factor.
constexpr double kWorse = 4;
/// What is left in a cluster, relative to what there is to stop, that calls for contacts that yield: by these
/// shares of their W.
constexpr double kLeft = 1e-6, kLeftOfMany = 1e-2;
constexpr double kYielding = 1e-4;
/// Impulses that stay bounded may leave this many times what others leave.
constexpr double kBounded = 2;
/// Joints hold a contact fast that impulses move by less than this part of what they would move it without.
constexpr double kFast = 1e-9;
/// Share of the step so far in Newton's method.
constexpr double kProximal = 1e-9;
/// W_c of a contact is made of full rank by this share of its largest entry.
constexpr double kSoft = 1e-12;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

ContactProblem::ContactProblem(const Model& model, const State& state, Workspace<double>& work,
                               const std::vector<Contact>& contacts)
    : model_(model),
      state_(state),
      work_(work),
      contacts_(contacts),
      mover_number_(model.parts().size(), -1),
      of_nodes_(model.parts().size()) {
  for (const Contact& contact : contacts) {
    Block block;
    block.mu = contact.friction;
    const Vec3<double> t1 = contact.normal.unitOrthogonal();
    block.axes << contact.normal, t1, contact.normal.cross(t1);
    add_side(block, contact.a, contact.x, 1);
    if (contact.b.part >= 0) add_side(block, contact.b, contact.x, -1);
    block.constant = -block.axes.transpose() * contact.carried;
    blocks_.push_back(std::move(block));
  }
  add_limits(state);
  for (Block& block : blocks_) complete(block);
}

std::size_t ContactProblem::mover_of(int part) {
  if (mover_number_[at(part)] >= 0) return at(mover_number_[at(part)]);
  Mover mover;
  const PartModel& m = model_.parts()[at(part)];
  const int number = static_cast<int>(movers_.size());
  if (m.island >= 0) {
    mover.island = &model_.islands()[at(m.island)];
    for (const int other : mover.island->parts) mover_number_[at(other)] = number;
  } else {
    mover.part = part;
    mover_number_[at(part)] = number;
  }
  mover.before = velocities_of(mover, state_);
  mover.x = mover.before;
  movers_.push_back(std::move(mover));
  return at(number);
}

/// Of a state whose coordinates may be those of an earlier time.
VecX<double> ContactProblem::velocities_of(const Mover& mover, const State& state) const {
  if (mover.node >= 0) return node_motion(model_, state, mover.part, mover.node).x_dot;
  auto take = [&](int part, Eigen::Ref<VecX<double>> x) {
    take_velocity(model_.parts()[at(part)], work_.parts[at(part)], state.v, x);
  };
  VecX<double> x;
  if (mover.island == nullptr) {
    x.resize(model_.parts()[at(mover.part)].n_x());
    take(mover.part, x);
    return x;
  }
  x.resize(mover.island->n_v);
  for (std::size_t i = 0; i < mover.island->parts.size(); ++i) {
    const int part = mover.island->parts[i];
    take(part, x.segment(mover.island->first[i], model_.parts()[at(part)].n_x()));
  }
  return x;
}

std::vector<Vec3<double>> ContactProblem::velocities(const State& of) const {
  std::vector<VecX<double>> x;
  for (const Mover& mover : movers_) x.push_back(velocities_of(mover, of));
  std::vector<Vec3<double>> all;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Vec3<double> u = -blocks_[k].axes.transpose() * contacts_[k].carried;
    for (const Side& side : blocks_[k].sides) u += side.J * x[side.mover].segment(side.first, side.J.cols());
    all.push_back(blocks_[k].axes * u);
  }
  return all;
}

std::size_t ContactProblem::mover_of_node(int part, int node) {
  std::vector<int>& numbers = of_nodes_[at(part)];
  if (numbers.empty())
    numbers.resize(at(static_cast<int>(model_.parts()[at(part)].local->mesh().X.rows())), -1);
  int& number = numbers[at(node)];
  if (number < 0) {
    number = static_cast<int>(movers_.size());
    Mover mover;
    mover.part = part;
    mover.node = node;
    mover.before = velocities_of(mover, state_);
    mover.x = mover.before;
    movers_.push_back(std::move(mover));
  }
  return at(number);
}

int ContactProblem::first_in(const Mover& mover, int part) const {
  if (mover.island == nullptr) return 0;
  const auto& parts = mover.island->parts;
  return mover.island
      ->first[at(static_cast<int>(std::find(parts.begin(), parts.end(), part) - parts.begin()))];
}

void ContactProblem::add_side(Block& block, const ContactSide& side, const Vec3<double>& x, double sign) {
  const PartModel& m = model_.parts()[at(side.part)];
  if (m.q0 < 0) return;
  if (side.at_nodes()) {
    for (std::size_t k = 0; k < side.node.size() && side.node[k] >= 0; ++k)
      block.sides.push_back({mover_of_node(side.part, side.node[k]), 0,
                             sign * side.weight[static_cast<Eigen::Index>(k)] * block.axes.transpose()});
    return;
  }
  const PartWorkspace<double>& w = work_.parts[at(side.part)];
  const std::size_t mover = mover_of(side.part);
  const Mat3<double> D = sign * block.axes.transpose() * w.R;
  Side s{mover, first_in(movers_[mover], side.part), Eigen::Matrix3Xd(3, m.n_x())};
  s.J.leftCols<3>() = D;
  s.J.middleCols<3>(3) = -D * skew<double>(w.R.transpose() * (x - w.c));
  if (m.n_s > 0) {
    std::vector<PointJet<double>> jets;
    Counters counters;
    m.part->points({side.material}, w.q_s, w.q_s_dot, jets, counters);
    s.J.rightCols(m.n_s) = D * jets[0].J;
  }
  block.sides.push_back(std::move(s));
}

/// Parameters at their limits do not leave them.
void ContactProblem::add_limits(const State& state) {
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const Mover& mover = movers_[i];
    if (mover.node >= 0) continue;
    const std::vector<int> alone{mover.part};
    for (const int part : mover.island == nullptr ? alone : mover.island->parts) {
      const PartModel& m = model_.parts()[at(part)];
      for (int k = 0; k < m.n_s; ++k) {
        const int mode = state.at_limit[at(m.limit0 + k)];
        if (m.local != nullptr || mode == 0 || work_.parts[at(part)].held(6 + k)) continue;
        Block block;
        block.rows = 1;
        Side side{i, first_in(mover, part), Eigen::Matrix3Xd::Zero(3, m.n_x())};
        side.J(0, 6 + k) = -mode;
        block.sides.push_back(std::move(side));
        blocks_.push_back(std::move(block));
      }
    }
  }
}

/// Responses of the movers, while their joints hold, and W of the block.
void ContactProblem::complete(Block& block) {
  for (const Side& side : block.sides) {
    auto found = std::find_if(block.responses.begin(), block.responses.end(),
                              [&](const Response& r) { return r.mover == side.mover; });
    const Mover& mover = movers_[side.mover];
    if (found == block.responses.end()) {
      block.responses.push_back({side.mover, MatX<double>::Zero(mover.x.size(), block.rows), {}});
      found = block.responses.end() - 1;
    }
    if (mover.node >= 0) {
      found->Y += side.J.topRows(block.rows).transpose() /
                  model_.parts()[at(mover.part)].local->mesh().mass[mover.node];
      continue;
    }
    const int n = static_cast<int>(side.J.cols());
    int part = mover.part;
    if (mover.island != nullptr)
      part = mover.island->parts[at(
          static_cast<int>(std::find(mover.island->first.begin(), mover.island->first.end(), side.first) -
                           mover.island->first.begin()))];
    for (int r = 0; r < block.rows; ++r) {
      VecX<double> force = side.J.row(r).transpose();
      work_.parts[at(part)].solve_mass(force);
      found->Y.col(r).segment(side.first, n) += force;
    }
  }
  double loose = 0;  // how far impulses move it as if there were no joints
  for (const Side& side : block.sides)
    for (const Response& response : block.responses)
      if (response.mover == side.mover)
        loose = std::max(loose,
                         (side.J * response.Y.middleRows(side.first, side.J.cols())).diagonal().maxCoeff());
  for (Response& response : block.responses) {
    const Mover& mover = movers_[response.mover];
    if (mover.island == nullptr) continue;
    const Group<double, Eigen::Dynamic> group(model_, work_, *mover.island, true);
    response.lambda.setZero(mover.island->rows, block.rows);
    for (int r = 0; r < block.rows; ++r) {
      VecX<double> x = response.Y.col(r), rows;
      for (int round = 0; round < (group.is_rough() ? 2 : 1); ++round) {
        group.joint_rows(x, rows);
        response.lambda.col(r) += group.correct(rows, x);
      }
      response.Y.col(r) = x;
    }
  }
  for (const Side& side : block.sides)
    for (const Response& response : block.responses)
      if (response.mover == side.mover)
        block.W.leftCols(block.rows) += side.J * response.Y.middleRows(side.first, side.J.cols());
  block.W = (0.5 * (block.W + block.W.transpose())).eval();
  if (!(block.W.diagonal().maxCoeff() > kFast * loose)) {  // joints hold it fast
    block.responses.clear();
    return;
  }
  block.W.diagonal().array() += kSoft * block.W.diagonal().maxCoeff();
}

Vec3<double> ContactProblem::velocity(const Block& block) const {
  Vec3<double> u = block.constant;
  for (const Side& side : block.sides)
    if (movers_[side.mover].node >= 0)
      u.noalias() += side.J.leftCols<3>() * movers_[side.mover].x.head<3>();
    else
      u.noalias() += side.J * movers_[side.mover].x.segment(side.first, side.J.cols());
  if (softness_ > 0) u += softness_ * block.W.diagonal().cwiseProduct(block.p);
  return u;
}

/// The impulse that its law asks for when u is the velocity with the impulse it has.
Vec3<double> ContactProblem::met(const Block& block, const Vec3<double>& u) const {
  if (block.rows == 1) return {std::max(0.0, block.p[0] - u[0] / ((1 + softness_) * block.W(0, 0))), 0, 0};
  Vec3<double> b = u - block.W * block.p;
  if (softness_ > 0) b -= softness_ * block.W.diagonal().cwiseProduct(block.p);
  return block.law.push(b);
}

void ContactProblem::push(const Block& block, const Vec3<double>& impulse) {
  for (const Response& response : block.responses)
    if (movers_[response.mover].node >= 0)
      movers_[response.mover].x.head<3>().noalias() += response.Y.topLeftCorner<3, 3>() * impulse;
    else
      movers_[response.mover].x.noalias() += response.Y * impulse.head(block.rows);
}

std::vector<ContactProblem::Cluster> ContactProblem::clusters() {
  std::vector<std::size_t> leader(movers_.size());
  for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = i;
  auto leader_of = [&](std::size_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (const Block& block : blocks_)
    for (const Side& side : block.sides) {
      const std::size_t one = leader_of(block.sides.front().mover), other = leader_of(side.mover);
      leader[std::max(one, other)] = std::min(one, other);
    }
  std::vector<std::size_t> number(movers_.size()), blocks, movers;
  auto count = [](std::vector<std::size_t>& counts, std::size_t i) { ++counts[i + 1]; };
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const std::size_t first = leader_of(i);  // no later than i
    if (first == i) {
      number[i] = movers.size();
      movers.push_back(0);
    } else {
      number[i] = number[first];
    }
  }
  const std::size_t n = movers.size();
  auto cluster_of = [&](const Block& block) { return number[block.sides.front().mover]; };
  movers.assign(n + 1, 0);
  blocks.assign(n + 1, 0);
  for (const std::size_t i : number) count(movers, i);
  for (const Block& block : blocks_)
    if (!block.sides.empty()) count(blocks, cluster_of(block));
  for (std::size_t i = 0; i < n; ++i) {
    movers[i + 1] += movers[i];
    blocks[i + 1] += blocks[i];
  }
  clustered_.resize(blocks[n] + movers[n]);
  std::size_t *const all_blocks = clustered_.data(), *const all_movers = all_blocks + blocks[n];
  std::vector<Cluster> all;
  all.reserve(n);
  for (std::size_t i = 0; i < n; ++i)
    all.push_back({{all_blocks + blocks[i], all_blocks + blocks[i + 1]},
                   {all_movers + movers[i], all_movers + movers[i + 1]},
                   0,
                   0});
  for (std::size_t i = 0; i < movers_.size(); ++i) all_movers[movers[number[i]]++] = i;
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    if (!blocks_[k].sides.empty()) all_blocks[blocks[cluster_of(blocks_[k])]++] = k;
  return all;
}

/// Velocities of a cluster that count as zero, and those that may be left.
void ContactProblem::set_scale(Cluster& cluster) const {
  double scale = 0, terms = 0;
  for (const std::size_t k : cluster.blocks) {
    const Block& block = blocks_[k];
    scale = std::max(scale, velocity(block).lpNorm<Eigen::Infinity>());
    for (const Side& side : block.sides)
      terms = std::max(
          terms, side.J.lpNorm<Eigen::Infinity>() *
                     movers_[side.mover].x.segment(side.first, side.J.cols()).lpNorm<Eigen::Infinity>());
  }
  cluster.nodes = std::any_of(cluster.movers.begin(), cluster.movers.end(),
                              [&](std::size_t i) { return movers_[i].node >= 0; });
  cluster.exact = std::max((cluster.nodes ? kExactOfNodes : kExact) * scale,
                           kUlps * std::numeric_limits<double>::epsilon() * terms);
  cluster.allowed = std::max(
      cluster.exact, (cluster.nodes || cluster.blocks.size() > kMostDense ? kLeftOfMany : kLeft) * scale);
}

double ContactProblem::sweep(const Cluster& cluster, bool forward) {
  double change = 0;
  const std::size_t n = cluster.blocks.size();
  for (std::size_t k = 0; k < n; ++k) {
    Block& block = blocks_[cluster.blocks[forward ? k : n - 1 - k]];
    if (block.responses.empty()) continue;
    const Vec3<double> p = met(block, velocity(block)), dp = p - block.p;
    push(block, dp);
    block.p = p;
    change = std::max(change, (block.W * dp).lpNorm<Eigen::Infinity>());
  }
  return change;
}

double ContactProblem::residual(const Cluster& cluster) const {
  double worst = 0;
  for (const std::size_t k : cluster.blocks) {
    const Block& block = blocks_[k];
    if (block.responses.empty()) {  // fixed, or held fast by joints: it cannot be stopped
      worst = std::max(worst, -velocity(block)[0]);
      continue;
    }
    const Vec3<double> dp = met(block, velocity(block)) - block.p;
    worst = std::max(worst, (block.W * dp).lpNorm<Eigen::Infinity>());
  }
  return worst;
}

void ContactProblem::take(const Cluster& cluster, Iterate& iterate) const {
  Eigen::Index n = 0;
  for (const std::size_t i : cluster.movers) n += movers_[i].x.size();
  iterate.p.resize(static_cast<Eigen::Index>(3 * cluster.blocks.size()));
  iterate.x.resize(n);
  for (std::size_t k = 0; k < cluster.blocks.size(); ++k)
    iterate.p.segment<3>(static_cast<Eigen::Index>(3 * k)) = blocks_[cluster.blocks[k]].p;
  n = 0;
  for (const std::size_t i : cluster.movers) {
    iterate.x.segment(n, movers_[i].x.size()) = movers_[i].x;
    n += movers_[i].x.size();
  }
}

void ContactProblem::set(const Cluster& cluster, const Iterate& iterate) {
  for (std::size_t k = 0; k < cluster.blocks.size(); ++k)
    blocks_[cluster.blocks[k]].p = iterate.p.segment<3>(static_cast<Eigen::Index>(3 * k));
  Eigen::Index n = 0;
  for (const std::size_t i : cluster.movers) {
    movers_[i].x = iterate.x.segment(n, movers_[i].x.size());
    n += movers_[i].x.size();
  }
}

/// Newton's method on Coulomb's law of all contacts of a cluster at once in the form of Alart and Curnier
/// (1991),
///   p_n = (p_n - r u_n)+,   p_t = the point of the disc of radius mu (p_n - r u_n)+ nearest to p_t - r u_t,
/// with a share of the step so far in u, so that impulses that depend on each other stay as near as they can.
/// Leaves the best it has seen; returns whether that is better than what it began with.
bool ContactProblem::newton(const Cluster& cluster) {
  const Numbers& ours = cluster.blocks;
  const auto n = static_cast<Eigen::Index>(3 * ours.size());
  MatX<double> A = MatX<double>::Zero(n, n);  // takes the impulses to their velocities
  for (std::size_t i = 0; i < ours.size(); ++i)
    for (std::size_t j = 0; j < ours.size(); ++j)
      for (const Side& side : blocks_[ours[i]].sides)
        for (const Response& response : blocks_[ours[j]].responses)
          if (response.mover == side.mover)
            A.block(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j), 3,
                    blocks_[ours[j]].rows) += side.J * response.Y.middleRows(side.first, side.J.cols());
  if (softness_ > 0)
    for (std::size_t i = 0; i < ours.size(); ++i)
      A.diagonal().segment<3>(static_cast<Eigen::Index>(3 * i)) += softness_ * blocks_[ours[i]].W.diagonal();
  Iterate best;
  take(cluster, best);
  best.residual = residual(cluster);
  const double start = best.residual;
  int futile = 0;
  const int most_futile = ours.size() > kDear ? kMostFutile : kMostNewton;
  for (int step = 0; step < kMostNewton && futile < most_futile && best.residual > cluster.exact; ++step) {
    MatX<double> K = MatX<double>::Zero(n, n);
    VecX<double> F = VecX<double>::Zero(n);
    for (std::size_t k = 0; k < ours.size(); ++k) {
      const Block& block = blocks_[ours[k]];
      const auto row = static_cast<Eigen::Index>(3 * k);
      const Vec3<double> u = velocity(block);
      const double scale = block.W.diagonal().maxCoeff(), r = 1 / scale, ahead = block.p[0] - r * u[0];
      auto U = A.middleRows<3>(row);
      if (block.responses.empty() || !(ahead > 0)) {
        K.block<3, 3>(row, row).setIdentity();
        F.segment<3>(row) = block.p;
        continue;
      }
      K.row(row) = r * U.row(0);
      K(row, row) += kProximal;
      F[row] = r * u[0];
      auto tangents = K.middleRows<2>(row + 1);
      const Eigen::Vector2d pull = block.p.tail<2>() - r * u.tail<2>();
      const double radius = block.mu * ahead;
      if (block.rows == 1 || radius == 0) {
        K.block<2, 2>(row + 1, row + 1).setIdentity();
        F.segment<2>(row + 1) = block.p.tail<2>();
      } else if (pull.norm() <= radius) {
        tangents = r * U.bottomRows<2>();
        K.block<2, 2>(row + 1, row + 1) += kProximal * Eigen::Matrix2d::Identity();
        F.segment<2>(row + 1) = r * u.tail<2>();
      } else {
        const Eigen::Vector2d e = pull.normalized();
        const Eigen::Matrix2d turn = radius / pull.norm() * (Eigen::Matrix2d::Identity() - e * e.transpose());
        tangents = r * block.mu * e * U.row(0) + r * turn * U.bottomRows<2>();
        tangents.block<2, 1>(0, row) -= block.mu * e;
        tangents.block<2, 2>(0, row + 1) += Eigen::Matrix2d::Identity() - turn;
        F.segment<2>(row + 1) = block.p.tail<2>() - radius * e;
      }
    }
    const VecX<double> change = -K.partialPivLu().solve(F);
    if (!change.allFinite()) break;
    for (std::size_t k = 0; k < ours.size(); ++k) {
      Block& block = blocks_[ours[k]];
      const Vec3<double> dp = change.segment<3>(static_cast<Eigen::Index>(3 * k));
      push(block, dp);
      block.p += dp;
    }
    const double now = residual(cluster);
    ++futile;
    if (now < best.residual) {
      futile = 0;
      take(cluster, best);
      best.residual = now;
    }
  }
  set(cluster, best);
  return best.residual < start;
}

/// Sweeps there and back as a fixed point p = g(p), extrapolated from the last of them to where p - g(p)
/// would be least if g were linear (Anderson 1965), which it is once contacts have settled on whether they
/// slide. Leaves the best it has seen; returns whether that is exact.
bool ContactProblem::relax(const Cluster& cluster, int most, int history, int& sweeps) {
  const auto n = static_cast<Eigen::Index>(3 * cluster.blocks.size());
  VecX<double> weight(n);  // impulses as velocities
  for (std::size_t k = 0; k < cluster.blocks.size(); ++k)
    weight.segment<3>(static_cast<Eigen::Index>(3 * k))
        .setConstant(std::max(blocks_[cluster.blocks[k]].W(0, 0), std::numeric_limits<double>::min()));
  Iterate now, next, best;
  take(cluster, now);
  MatX<double> dr(n, history), dp(n, history), dx(now.x.size(), history);
  VecX<double> last_r, last_p, last_x;
  int filled = 0, slot = 0;
  for (int i = 0; i < most; i += 2) {
    sweep(cluster, true);
    const double change = sweep(cluster, false);
    sweeps += 2;
    take(cluster, next);
    const VecX<double> r = weight.cwiseProduct(next.p - now.p);
    next.residual = std::max(change, r.lpNorm<Eigen::Infinity>());
    if (next.residual < best.residual) best = next;
    if (next.residual <= cluster.exact) return true;
    if (history == 0) {
      now = next;
      continue;
    }
    if (!(next.residual <= kWorse * best.residual)) {
      filled = 0;
      slot = 0;
      now = best;
      last_r.resize(0);
      set(cluster, now);
      continue;
    }
    if (last_r.size() > 0) {
      dr.col(slot) = r - last_r;
      dp.col(slot) = next.p - last_p;
      dx.col(slot) = next.x - last_x;
      slot = (slot + 1) % history;
      filled = std::min(filled + 1, history);
    }
    last_r = r;
    last_p = next.p;
    last_x = next.x;
    now = next;
    if (filled > 0) {
      const VecX<double> gamma = dr.leftCols(filled).colPivHouseholderQr().solve(r);
      if (gamma.allFinite()) {
        now.p.noalias() -= dp.leftCols(filled) * gamma;
        now.x.noalias() -= dx.leftCols(filled) * gamma;
      }
    }
    set(cluster, now);
  }
  set(cluster, best);
  return false;
}

/// Returns whether it found the solution.
bool ContactProblem::iterate(const Cluster& cluster, int& sweeps) {
  // Newton's method is fast near a solution, plain sweeps are slow but sure, extrapolated ones are between.
  const bool dense = cluster.blocks.size() <= (cluster.nodes ? kMostDenseOfNodes : kMostDense);
  for (std::size_t round = 0; round < (cluster.nodes ? kRoundsOfNodes : kRounds.size()); ++round) {
    const auto& [most, history] = kRounds[round];
    if (!dense && history == 0) continue;  // it would take too long
    if (relax(cluster, most, history, sweeps)) return true;
    if (dense && newton(cluster) && residual(cluster) <= cluster.exact) return true;
  }
  return false;
}

/// Contacts of a cluster give way by this share of W.
void ContactProblem::yield(const Cluster& cluster, double softness) {
  softness_ = softness;
  for (const std::size_t k : cluster.blocks) {
    Block& block = blocks_[k];
    Mat3<double> W = block.W;
    W.diagonal() *= 1 + softness;
    block.law = CoulombLaw(W, block.rows == 1 ? 0 : block.mu);
  }
}

/// Each cluster by itself. What has no solution, as where joints and contacts contradict each other, or where
/// none is found, is solved with contacts that yield, which has one; the better of the two stays.
void ContactProblem::iterate(ContactSolution& solution) {
  std::vector<VecX<double>> start_x;
  for (const Mover& mover : movers_) start_x.push_back(mover.x);
  for (const Block& block : blocks_)
    if (block.sides.empty()) solution.residual = std::max(solution.residual, -velocity(block)[0]);
  for (Cluster& cluster : clusters()) {
    if (cluster.blocks.size() == 0) continue;
    yield(cluster, 0);
    set_scale(cluster);
    for (const std::size_t k : cluster.blocks)
      if (k < begin_.size()) {
        blocks_[k].p = blocks_[k].axes.transpose() * begin_[k];
        push(blocks_[k], blocks_[k].p);
      }
    if (cluster.blocks.size() == 1) {
      sweep(cluster, true);
      ++solution.sweeps;
      solution.residual = std::max(solution.residual, residual(cluster));
      continue;
    }
    Iterate start, found;
    take(cluster, start);
    const bool solved = iterate(cluster, solution.sweeps);
    double left = residual(cluster);
    if (!solved && left > cluster.allowed) {
      ++solution.fallbacks;
      take(cluster, found);
      set(cluster, start);
      yield(cluster, kYielding);
      iterate(cluster, solution.sweeps);
      yield(cluster, 0);
      const double yielding = residual(cluster);
      if (yielding < kBounded * left)
        left = yielding;
      else
        set(cluster, found);
    }
    solution.residual = std::max(solution.residual, left);
  }
  // Rounding has grown where impulses were extrapolated: what is pushed moves as they say in the end.
  for (std::size_t i = 0; i < movers_.size(); ++i) movers_[i].x = start_x[i];
  for (const Block& block : blocks_) push(block, block.p);
}

ContactSolution ContactProblem::solve(double since_of_limits) {
  ContactSolution solution;
  for (std::size_t k = 0; k < contacts_.size(); ++k) blocks_[k].constant[0] -= contacts_[k].rebound;
  iterate(solution);
  for (Mover& mover : movers_) mover.shift.setZero(mover.x.size());
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& block = blocks_[k];
    const double since = k < contacts_.size() ? contacts_[k].since : since_of_limits;
    for (const Response& response : block.responses)
      movers_[response.mover].shift += since * response.Y * block.p.head(block.rows);
    if (k >= contacts_.size()) continue;
    solution.impulse.push_back(block.axes * block.p);
    Vec3<double> u = velocity(block);
    u[0] += contacts_[k].rebound;
    solution.velocity.push_back(block.axes * u);
  }
  return solution;
}

void ContactProblem::add_joint_impulses(VecX<double>& rows) const {
  for (const Block& block : blocks_)
    for (const Response& response : block.responses) {
      const Island* island = movers_[response.mover].island;
      if (island == nullptr) continue;
      const VecX<double> lambda = response.lambda * block.p.head(block.rows);
      for (const int j : island->joints) {
        const JointModel& joint = model_.joints()[at(j)];
        rows.segment(joint.row, joint.rows) += lambda.segment(joint.island_row, joint.rows);
      }
    }
}

void ContactProblem::part_bodies(double most) {
  begin_.clear();
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    Block& block = blocks_[k];
    block.mu = 0;
    block.p.setZero();
    block.constant.setZero();
    if (k >= contacts_.size()) continue;
    double gap = contacts_[k].gap;
    for (const Side& side : block.sides)
      if (const VecX<double>& shift = movers_[side.mover].shift; shift.size() > 0)
        gap += side.J.row(0).dot(shift.segment(side.first, side.J.cols()));
    block.constant[0] = std::max(gap, -most);
  }
  std::vector<VecX<double>> rates;
  for (Mover& mover : movers_) {
    rates.push_back(mover.x);
    mover.x.setZero();
  }
  ContactSolution solution;
  iterate(solution);
  for (std::size_t k = 0; k < movers_.size(); ++k) {
    Mover& mover = movers_[k];
    mover.shift = mover.shift.size() > 0 ? VecX<double>(mover.shift + mover.x) : mover.x;
    mover.x = rates[k];
  }
}

}  // namespace pliant
