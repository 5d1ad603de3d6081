#include <pliant/contact/contact_problem.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <pliant/body/group.h>
#include <pliant/contact/node_motion.h>
#include <pliant/solve/coulomb.h>

namespace pliant {

namespace {

/// Sweeps end when impulses change velocities by less than this, relative to what there is to stop.
constexpr double kExact = 1e-13;
constexpr int kMostRounds = 40, kSweepsARound = 12, kMostNewton = 20;
/// The same where nodes are pushed, many at a time and lightly coupled.
constexpr double kExactOfNodes = 1e-8;
constexpr int kRoundsOfNodes = 3, kSweepsOfNodes = 100;
/// Most blocks with nodes that are solved as one system.
constexpr std::size_t kMostDenseOfNodes = 60;
/// Most blocks that are solved as one system.
constexpr std::size_t kMostDense = 400;
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
  Side s{mover, first_in(movers_[mover], side.part), MatX<double>(3, m.n_x())};
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
        Side side{i, first_in(mover, part), MatX<double>::Zero(3, m.n_x())};
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
  for (const Side& side : block.sides) u += side.J * movers_[side.mover].x.segment(side.first, side.J.cols());
  return u;
}

/// The impulse that its law asks for when u is the velocity with the impulse it has.
Vec3<double> ContactProblem::met(const Block& block, const Vec3<double>& u) {
  if (block.rows == 1) return {std::max(0.0, block.p[0] - u[0] / block.W(0, 0)), 0, 0};
  return solve_coulomb(block.W, u - block.W * block.p, block.mu);
}

void ContactProblem::push(const Block& block, const Vec3<double>& impulse) {
  for (const Response& response : block.responses)
    movers_[response.mover].x += response.Y * impulse.head(block.rows);
}

double ContactProblem::sweep(bool forward) {
  double change = 0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    Block& block = blocks_[forward ? k : blocks_.size() - 1 - k];
    if (block.responses.empty()) continue;
    const Vec3<double> p = met(block, velocity(block)), dp = p - block.p;
    push(block, dp);
    block.p = p;
    change = std::max(change, (block.W * dp).lpNorm<Eigen::Infinity>());
  }
  return change;
}

double ContactProblem::residual() const {
  double worst = 0;
  for (const Block& block : blocks_) {
    if (block.responses.empty()) {  // fixed, or held fast by joints: it cannot be stopped
      worst = std::max(worst, -velocity(block)[0]);
      continue;
    }
    const Vec3<double> dp = met(block, velocity(block)) - block.p;
    worst = std::max(worst, (block.W * dp).lpNorm<Eigen::Infinity>());
  }
  return worst;
}

/// The matrix that takes the impulses of all blocks to their velocities.
MatX<double> ContactProblem::matrix() const {
  const auto n = static_cast<Eigen::Index>(3 * blocks_.size());
  MatX<double> A = MatX<double>::Zero(n, n);
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (std::size_t j = 0; j < blocks_.size(); ++j)
      for (const Side& side : blocks_[i].sides)
        for (const Response& response : blocks_[j].responses)
          if (response.mover == side.mover)
            A.block(3 * i, 3 * j, 3, blocks_[j].rows) +=
                side.J * response.Y.middleRows(side.first, side.J.cols());
  return A;
}

/// Newton's method on Coulomb's law of all contacts at once in the form of Alart and Curnier (1991),
///   p_n = (p_n - r u_n)+,   p_t = the point of the disc of radius mu (p_n - r u_n)+ nearest to p_t - r u_t,
/// with a share of the step so far in u, so that impulses that depend on each other stay as near as they can.
/// Returns whether it came nearer to the solution than before.
bool ContactProblem::newton(double exact) {
  const MatX<double> A = matrix();
  const Eigen::Index n = A.rows();
  double best = residual();
  const double start = best;
  std::vector<Vec3<double>> p_best;
  std::vector<VecX<double>> x_best;
  auto keep = [&] {
    p_best.clear();
    x_best.clear();
    for (const Block& block : blocks_) p_best.push_back(block.p);
    for (const Mover& mover : movers_) x_best.push_back(mover.x);
  };
  keep();
  for (int step = 0; step < kMostNewton && best > exact; ++step) {
    MatX<double> K = MatX<double>::Zero(n, n);
    VecX<double> F = VecX<double>::Zero(n);
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const Block& block = blocks_[k];
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
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      Block& block = blocks_[k];
      const Vec3<double> dp = change.segment<3>(static_cast<Eigen::Index>(3 * k));
      push(block, dp);
      block.p += dp;
    }
    const double now = residual();
    if (now < best) {
      best = now;
      keep();
    }
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k) blocks_[k].p = p_best[k];
  for (std::size_t k = 0; k < movers_.size(); ++k) movers_[k].x = x_best[k];
  return best < start;
}

int ContactProblem::iterate() {
  double scale = 0;
  for (const Block& block : blocks_) scale = std::max(scale, velocity(block).lpNorm<Eigen::Infinity>());
  const bool nodes = std::any_of(movers_.begin(), movers_.end(), [](const Mover& m) { return m.node >= 0; });
  const double exact = (nodes ? kExactOfNodes : kExact) * scale;
  const int in_round = nodes ? kSweepsOfNodes : kSweepsARound, rounds = nodes ? kRoundsOfNodes : kMostRounds;
  const std::size_t most_dense = nodes ? kMostDenseOfNodes : kMostDense;
  int sweeps = 0;
  for (int round = 0; round < rounds; ++round) {
    for (int i = 0; i < in_round; ++i, ++sweeps)
      if (sweep(i % 2 == 0) <= exact) return sweeps + 1;
    if (blocks_.size() <= most_dense && newton(exact) && residual() <= exact) return sweeps;
  }
  return sweeps;
}

ContactSolution ContactProblem::solve(double since_of_limits) {
  ContactSolution solution;
  for (std::size_t k = 0; k < contacts_.size(); ++k) blocks_[k].constant[0] -= contacts_[k].rebound;
  solution.sweeps = iterate();
  solution.residual = residual();
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
  std::vector<VecX<double>> rates;
  for (Mover& mover : movers_) {
    rates.push_back(mover.before);
    mover.before.setZero();
    mover.x.setZero();
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    blocks_[k].mu = 0;
    blocks_[k].p.setZero();
    blocks_[k].constant.setZero();
    if (k < contacts_.size()) blocks_[k].constant[0] = std::max(contacts_[k].gap, -most);
  }
  iterate();
  for (std::size_t k = 0; k < movers_.size(); ++k) {
    movers_[k].shift = movers_[k].x;
    movers_[k].before = movers_[k].x = rates[k];
  }
}

}  // namespace pliant
