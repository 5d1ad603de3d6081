// The set-up of a model: the places of parts and joints in the flat vectors, the islands, and the joint
// solver of each island.
#include <pliant/body/model.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <pliant/math/disjoint_sets.h>
#include <pliant/part/local/patch_weights.h>

namespace pliant {

namespace {

/// Largest number of multiplications for which the factorisation by blocks is used without a comparison with
/// the factorisation of the augmented matrix.
constexpr long kCheapBlocks = 10000;
/// Number of pairs of joints on common parts, summed over an island, above which the blocks of W_c are not
/// considered.
constexpr double kMaxJointPairs = 1e7;
/// Ratio of the smallest to the largest mass of the parts of an island, below which lambda is refined
/// iteratively.
constexpr double kUneven = 1e-4;

std::vector<int> all_parts(const MultiBody& body) {
  std::vector<int> all(body.parts().size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

RigidMass::RigidMass(const Inertia<double>& constant, const VecX<double>& floor, bool diagonal)
    : inertia(constant) {
  factor.compute(diagonal ? MatX<double>(inertia.M.diagonal().asDiagonal()) : MatX<double>(inertia.M), floor);
  for (int k = 0; k < 6; ++k) {
    VecMax<double> column = VecMax<double>::Unit(6, k);
    factor.solve(column);
    inverse.col(k) = column;
  }
}

Model::Model(const MultiBody& body) : Model(body, all_parts(body)) {}

Model::Model(const MultiBody& body, std::vector<int> parts) : body_(&body), part_numbers_(std::move(parts)) {
  if (!body.gravity_at(0).allFinite()) throw std::invalid_argument("gravity at time 0 is not finite");
  parts_.reserve(part_numbers_.size());
  RigidMasses masses;
  for (const int i : part_numbers_) add_part(*body.parts()[static_cast<std::size_t>(i)], masses);
  add_springs();
  add_forces_and_torques();
  add_distributed_forces();
  body.stabilization.check();
  for (std::size_t j = 0; j < body.joints().size(); ++j) {
    const std::vector<Point>& points = body.joints()[j]->points();
    if (!is_whole() &&
        std::none_of(points.begin(), points.end(), [&](const Point& p) { return moves(p.part); }))
      continue;
    joint_numbers_.push_back(static_cast<int>(j));
    add_joint(*body.joints()[j]);
  }
  add_actuation();
  note_switch_times();
  share_joint_points();
  assign_side_offsets();
  make_islands();
  evaluate_rigid_ports();
  mark_loaded_parts();
  make_rigid_islands();
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i].island < 0) lone_parts_.push_back(static_cast<int>(i));
}

DisjointSets Model::connected_parts() const {
  auto has = [&](int part) { return parts_[static_cast<std::size_t>(part)].q0 >= 0; };
  DisjointSets sets(parts_.size());
  for (const Island& island : islands_)
    for (const int i : island.parts) sets.unite(i, island.parts.front());
  for (const auto& [a, b] : load_connections_)
    if (has(a) && has(b)) sets.unite(a, b);
  return sets;
}

bool Model::forms_clusters() const {
  if (!body_->contact.active || has_few_moving_parts()) return false;
  DisjointSets connected = connected_parts();
  int sets = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].local != nullptr) return false;
    if (parts_[i].q0 >= 0 && connected.root(static_cast<int>(i)) == static_cast<int>(i)) ++sets;
  }
  return sets > 1;
}

int Model::number_of(const Part& part) const {
  const int number = body_->index(part);
  if (is_whole()) return number;
  const auto found = std::lower_bound(part_numbers_.begin(), part_numbers_.end(), number);
  return found == part_numbers_.end() || *found != number ? -1
                                                          : static_cast<int>(found - part_numbers_.begin());
}

void Model::add_part(Part& part, RigidMasses& known) {
  body_->prepare(part);
  PartModel m;
  m.part = &part;
  m.use = part.use();
  m.size = part.size();
  m.n_s = part.n_s();
  m.motion = part.motion();
  m.local = part.local();
  m.drag = part.drag();
  m.q0 = part.fixed() ? -1 : n_q_;
  m.v0 = part.fixed() ? -1 : n_v_;
  m.limit0 = n_limits_;
  m.rest.resize(m.n_s);
  for (int k = 0; k < m.n_s; ++k) {
    const Parameter& p = part.parameters().moving(k);
    m.limits.push_back(p.limits);
    m.rest[k] = p.rest_value();
    m.actuated = m.actuated || !p.rest.is_constant();
  }
  m.R0 = part.R0().toRotationMatrix();
  n_q_ += part.n_q();
  n_v_ += part.n_v();
  n_limits_ += m.n_s;
  if (!part.fixed()) ++n_moving_;

  m.inertia_floor = VecX<double>::Zero(6 + m.n_s);
  for (int k = 0; k < m.n_s; ++k) m.inertia_floor[6 + k] = part.inertia_floor(k);
  if (part.rigid()) {
    std::shared_ptr<const RigidMass>& mass = known[&part.constants()];
    if (!mass)
      mass =
          std::make_shared<const RigidMass>(part.rest_inertia(), m.inertia_floor, part.has_diagonal_mass());
    m.rigid_mass = mass;
  }
  parts_.push_back(std::move(m));
}

void Model::add_springs() {
  for (const auto& spring : body_->springs()) {
    if (!is_whole() && !moves(spring->a.part) && !moves(spring->b.part)) continue;
    const std::string what = "spring '" + spring->name + "'";
    SpringModel m{spring.get(), attach(spring->a, what), attach(spring->b, what), {}};
    if (m.a.part < 0 && m.b.part < 0) throw std::invalid_argument(what + " ties the world to itself");
    springs_.push_back(m);
  }
}

void Model::add_forces_and_torques() {
  for (const auto& force : body_->forces()) {
    if (force->at.part == nullptr) throw std::invalid_argument("force '" + force->name + "' acts on no part");
    if (!is_whole() && !moves(force->at.part)) continue;
    forces_.push_back({force.get(), attach(force->at, "force '" + force->name + "'"), {}});
  }
  for (const auto& torque : body_->torques()) {
    const std::string what = "torque '" + torque->name + "'";
    if (torque->part == nullptr) throw std::invalid_argument(what + " acts on no part");
    if (torque->against == torque->part)
      throw std::invalid_argument(what + " acts on part '" + torque->part->name() + "' against itself");
    if (!is_whole() && !moves(torque->part) && !moves(torque->against)) continue;
    torques_.push_back({torque.get(),
                        number_of(*torque->part),
                        torque->against == nullptr ? -1 : number_of(*torque->against),
                        {}});
  }
}

void Model::note_switch_times() {
  auto note = [&](double on, double off) {
    for (const double time : {on, off})
      if (time > 0 && std::isfinite(time)) switch_times_.push_back(time);
  };
  for (const JointModel& joint : joints_) note(joint.joint->on(), joint.joint->off());
  if (body_->contact.active) {
    for (const ContactPlane& plane : body_->contact.planes) note(plane.on, plane.off);
    for (const ContactObstacle& obstacle : body_->contact.obstacles) note(obstacle.on, obstacle.off);
  }
  std::sort(switch_times_.begin(), switch_times_.end());
}

void Model::evaluate_rigid_ports() {
  Counters unused;
  for (PartModel& m : parts_)
    if (m.n_s == 0 && !m.ports.empty())
      m.part->points(m.ports, VecMax<double>(0), VecMax<double>(0), m.rigid_ports, unused);
}

void Model::make_rigid_islands() {
  for (Island& island : islands_) {
    if (!RigidIsland::applies_to(*this, island)) continue;
    island.rigid = static_cast<int>(rigid_islands_.size());
    for (const int i : island.parts) parts_[static_cast<std::size_t>(i)].rigid_island = island.rigid;
    rigid_islands_.emplace_back(*this, island);
  }
}

NodeWeights Model::node_weights(const Point& point) {
  const LocalDeformation* local = point.part->local();
  if (local == nullptr) return {};
  return point.patch > 0 ? patch_weights(*point.part, local->mesh(), point.material, point.patch)
                         : local->weights(*point.part, point.material);
}

PortRef Model::attach(const Point& point, const std::string& what) {
  if (point.part == nullptr) return {};
  const Material<double>& m = point.material;
  if (!(m.w >= 0 && m.w <= 1) || std::isnan(m.cu.x + m.su.x + m.cv.x + m.sv.x))
    throw std::invalid_argument(what + ": its point on part '" + point.part->name() +
                                "' needs finite angles, and w from 0 at the centre to 1 on the surface");
  const int part = number_of(*point.part);
  auto& ports = parts_[static_cast<std::size_t>(part)].ports;
  ports.push_back(point.material);
  const LocalDeformation* local = point.part->local();
  const bool has_nodes = local != nullptr && local->nodal() != nullptr;
  if (point.patch != 0 && (!(point.patch > 0) || !has_nodes))
    throw std::invalid_argument(what + ": its point on part '" + point.part->name() + "' " +
                                (has_nodes ? "needs a patch with a positive radius"
                                           : "has a patch of nodes, but the part does not deform by nodes"));
  if (local != nullptr) parts_[static_cast<std::size_t>(part)].node_weights.push_back(node_weights(point));
  parts_[static_cast<std::size_t>(part)].port_place.push_back(-1);
  return {part, static_cast<int>(ports.size()) - 1};
}

void Model::add_joint(const Joint& joint) {
  const std::string what = std::string(joint.type()) + " '" + joint.name() + "'";
  JointModel m{&joint, joint.rows(), n_rows_, {}, {}, -1, -1, -1, 0, false};
  double length = std::numeric_limits<double>::infinity();
  for (const Point& point : joint.points()) {
    m.at.push_back(attach(point, what));
    if (point.part == nullptr) {
      m.driven = m.driven || !point.world.is_constant();
      continue;
    }
    const int part = m.at.back().part;
    const PartModel& of = parts_[static_cast<std::size_t>(part)];
    m.driven = m.driven || of.motion != nullptr;
    if (of.q0 < 0) continue;
    length = std::min(length, of.size);
    const bool known =
        std::any_of(m.sides.begin(), m.sides.end(), [&](const JointSide& side) { return side.part == part; });
    if (known) continue;
    m.sides.push_back({part, -1, 0});
  }
  if (m.sides.empty()) throw std::invalid_argument(what + " ties no part that moves");
  const Part& only = *parts_[static_cast<std::size_t>(m.sides.front().part)].part;
  const bool on_one_part = joint.n_points() > joint.n_first() &&
                           std::all_of(joint.points().begin(), joint.points().end(),
                                       [&](const Point& point) { return point.part == &only; });
  if (on_one_part && only.rigid())
    throw std::invalid_argument(what + " ties part '" + only.name() + "', which does not deform, to itself");
  if (on_one_part) m.first_offset = 0;
  m.length = length;
  n_rows_ += m.rows;
  if (m.driven) driven_joints_.push_back(static_cast<int>(joints_.size()));
  joints_.push_back(std::move(m));
}

void Model::share_joint_points() {
  for (const JointModel& joint : joints_)
    for (const PortRef& ref : joint.at) {
      if (ref.part < 0) continue;
      PartModel& m = parts_[static_cast<std::size_t>(ref.part)];
      const auto port = static_cast<std::size_t>(ref.port);
      if (m.local == nullptr || m.node_weights[port].node.empty()) continue;
      const auto same = std::find(m.joint_points.begin(), m.joint_points.end(), m.node_weights[port]);
      m.port_place[port] = static_cast<int>(same - m.joint_points.begin());
      if (same == m.joint_points.end()) m.joint_points.push_back(m.node_weights[port]);
    }
}

void Model::assign_side_offsets() {
  for (JointModel& joint : joints_)
    for (JointSide& side : joint.sides) {
      side.offset = n_sides_;
      n_sides_ += parts_[static_cast<std::size_t>(side.part)].n_x() * joint.rows;
      if (joint.first_offset < 0) continue;
      joint.first_offset = n_sides_;
      n_sides_ += parts_[static_cast<std::size_t>(side.part)].n_x() * joint.rows;
    }
}

void Model::make_islands() {
  const SidesOfParts sides_of = number_joints();
  number_parts(sides_of);
  for (Island& island : islands_) {
    double lightest = std::numeric_limits<double>::infinity(), heaviest = 0;
    for (const int i : island.parts) {
      const double mass = parts_[static_cast<std::size_t>(i)].part->rest_inertia().mass;
      lightest = std::min(lightest, mass);
      heaviest = std::max(heaviest, mass);
    }
    island.uneven = lightest < kUneven * heaviest;
    choose_solver(island, sides_of);
    if (!island.augmented) add_couplings(island, sides_of);
  }
}

Model::SidesOfParts Model::number_joints() {
  DisjointSets joined(parts_.size());
  for (const JointModel& joint : joints_)
    for (const JointSide& side : joint.sides) joined.unite(joint.sides.front().part, side.part);
  std::vector<int> island_of(parts_.size(), -1);
  SidesOfParts sides_of(parts_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    JointModel& joint = joints_[j];
    int& number = island_of[static_cast<std::size_t>(joined.root(joint.sides.front().part))];
    if (number < 0) {
      number = static_cast<int>(islands_.size());
      islands_.emplace_back();
    }
    joint.island = number;
    Island& island = islands_[static_cast<std::size_t>(number)];
    for (std::size_t s = 0; s < joint.sides.size(); ++s)
      sides_of[static_cast<std::size_t>(joint.sides[s].part)].emplace_back(static_cast<int>(j),
                                                                           static_cast<int>(s));
    for (const PortRef& ref : joint.at)
      if (ref.part >= 0 && parts_[static_cast<std::size_t>(ref.part)].q0 < 0)
        island.anchors.push_back(ref.part);
    if (joint.joint->one_sided()) {
      island.strings.push_back(static_cast<int>(j));
      continue;
    }
    joint.node = static_cast<int>(island.joints.size());
    joint.island_row = island.rows;
    island.rows += joint.rows;
    island.joints.push_back(static_cast<int>(j));
  }
  return sides_of;
}

void Model::number_parts(const SidesOfParts& sides_of) {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (sides_of[i].empty()) continue;
    parts_[i].island = joints_[static_cast<std::size_t>(sides_of[i].front().first)].island;
    Island& island = islands_[static_cast<std::size_t>(parts_[i].island)];
    for (const auto& [joint, side] : sides_of[i])
      joints_[static_cast<std::size_t>(joint)].sides[static_cast<std::size_t>(side)].place =
          static_cast<int>(island.parts.size());
    island.parts.push_back(static_cast<int>(i));
    island.first.push_back(island.n_v);
    island.n_v += parts_[i].n_x();
  }
}

void Model::choose_solver(Island& island, const SidesOfParts& sides_of) {
  const JointSolver& solver = body_->joint_solver;
  auto equation = [&](int j) { return joints_[static_cast<std::size_t>(j)].node >= 0; };
  std::vector<int> rows;
  for (const int j : island.joints) rows.push_back(joints_[static_cast<std::size_t>(j)].rows);

  // The augmented matrix of Eq. (14). The nodes of its graph are parts and joints; the edges are the sides.
  std::vector<int> sizes;
  std::vector<std::pair<int, int>> edges;
  double pairs = 0;
  for (std::size_t p = 0; p < island.parts.size(); ++p) {
    sizes.push_back(parts_[static_cast<std::size_t>(island.parts[p])].n_x());
    double sides = 0;
    for (const auto& [j, side] : sides_of[static_cast<std::size_t>(island.parts[p])]) {
      if (!equation(j)) continue;
      edges.emplace_back(static_cast<int>(p),
                         static_cast<int>(island.parts.size()) + joints_[static_cast<std::size_t>(j)].node);
      sides += 1;
    }
    pairs += sides * sides / 2;
  }
  sizes.insert(sizes.end(), rows.begin(), rows.end());
  using Choice = JointSolver::Choice;
  island.augmented =
      solver.choice == Choice::augmented || (solver.choice == Choice::automatic && pairs > kMaxJointPairs);
  if (island.augmented) {
    island.factor_values = eliminate(sizes, edges, solver.order).values;
    return;
  }
  // The matrix W_c. The nodes of its graph are joints; the edges are the pairs of joints on a part.
  std::vector<std::pair<int, int>> meetings;
  for (const int i : island.parts)
    for (const auto& [a, side_a] : sides_of[static_cast<std::size_t>(i)])
      for (const auto& [b, side_b] : sides_of[static_cast<std::size_t>(i)])
        if (a < b && equation(a) && equation(b))
          meetings.emplace_back(joints_[static_cast<std::size_t>(a)].node,
                                joints_[static_cast<std::size_t>(b)].node);
  const Elimination blocks = cheapest_elimination(rows, meetings, solver.order);
  island.factor_values = blocks.values;
  if (solver.choice == Choice::automatic && blocks.products > kCheapBlocks) {
    const Elimination augmented = eliminate(sizes, edges, solver.order);
    island.augmented = augmented_is_faster(blocks, augmented);
    if (island.augmented) island.factor_values = augmented.values;
  }
  if (!island.augmented) island.pattern = BlockPattern(blocks);
}

void Model::add_couplings(Island& island, const SidesOfParts& sides_of) {
  for (const int i : island.parts)
    for (const auto& [a, side_a] : sides_of[static_cast<std::size_t>(i)])
      for (const auto& [b, side_b] : sides_of[static_cast<std::size_t>(i)]) {
        if (a > b || joints_[static_cast<std::size_t>(a)].node < 0 ||
            joints_[static_cast<std::size_t>(b)].node < 0)
          continue;
        int row = a, column = b, row_side = side_a, column_side = side_b;
        const JointModel &joint_a = joints_[static_cast<std::size_t>(a)],
                         &joint_b = joints_[static_cast<std::size_t>(b)];
        const BlockPattern::Place place = island.pattern.place(joint_a.node, joint_b.node);
        if (place.swapped) {
          std::swap(row, column);
          std::swap(row_side, column_side);
        }
        const JointModel &of_row = joints_[static_cast<std::size_t>(row)],
                         &of_column = joints_[static_cast<std::size_t>(column)];
        island.couplings.push_back({i, of_row.sides[static_cast<std::size_t>(row_side)].offset,
                                    of_column.sides[static_cast<std::size_t>(column_side)].offset,
                                    of_row.rows, of_column.rows, row, column, place.offset});
      }
  std::stable_sort(island.couplings.begin(), island.couplings.end(),
                   [](const Coupling& x, const Coupling& y) { return x.later_joint() < y.later_joint(); });
}

}  // namespace pliant
