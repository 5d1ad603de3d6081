// The initial state of a model; positions and gaps at a state; names of its coordinates and velocities.
#include <pliant/body/model.h>

#include <cmath>
#include <stdexcept>

namespace pliant {

namespace {
/// Adds LocalDeformation::initial_frame() and initial_frame_rate() to the state: the share of the given local
/// displacements and velocities that changes the frame and the parameters.
void displace_frame(const PartModel& m, State& state) {
  const Mat3<double> R = m.part->R0().toRotationMatrix();
  if (const VecX<double>& rate = m.local->initial_frame_rate(); rate.size() > 0) {
    state.v.segment<3>(m.v0) += R * rate.head<3>();
    state.v.segment(m.v0 + 3, 3 + m.n_s) += rate.tail(3 + m.n_s);
  }
  if (const VecX<double>& change = m.local->initial_frame(); change.size() > 0) {
    const Vec3<double> turn = change.segment<3>(3);
    const Eigen::Quaterniond now =
        m.part->R0() * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
    state.q.segment<3>(m.q0) += R * change.head<3>();
    state.q.segment<4>(m.q0 + 3) << now.w(), now.x(), now.y(), now.z();
    state.q.segment(m.q0 + 7, m.n_s) += change.tail(m.n_s);
  }
}
}  // namespace

State Model::initial_state() const {
  State state;
  state.q.setZero(n_q_);
  state.v.setZero(n_v_);
  state.at_limit.assign(static_cast<std::size_t>(n_limits_), 0);
  for (const JointModel& joint : joints_)
    state.joints.push_back(joint.joint->acts_at(0) ? JointMode::closing : JointMode::off);
  state.at_rest.assign(n_resting(), 0);
  state.inputs.resize(static_cast<Eigen::Index>(body_->inputs().size()));
  for (std::size_t k = 0; k < body_->inputs().size(); ++k)
    state.inputs[static_cast<Eigen::Index>(k)] = body_->inputs()[k].initial;
  for (const PartModel& m : parts_) {
    if (m.q0 < 0) continue;
    const Part& part = *m.part;
    state.q.segment<3>(m.q0) = part.c0();
    state.q.segment<4>(m.q0 + 3) << part.R0().w(), part.R0().x(), part.R0().y(), part.R0().z();
    state.v.segment<3>(m.v0) = part.c0_dot();
    state.v.segment<3>(m.v0 + 3) = part.omega0();
    for (int k = 0; k < m.n_s; ++k) {
      const Parameter& p = part.parameters().moving(k);
      state.q[m.q0 + 7 + k] = p.initial;
      state.v[m.v0 + 6 + k] = p.initial_rate;
    }
    if (m.local == nullptr) continue;
    state.q.segment(m.q0 + 7 + m.n_s, m.n_d()) = m.local->initial();
    state.v.segment(m.v0 + 6 + m.n_s, m.n_d()) = m.local->initial_rate();
    displace_frame(m, state);
  }
  record_limits(state);
  return state;
}

void Model::record_limits(State& state) const {
  for (const PartModel& m : parts_)
    for (int k = 0; k < m.n_s; ++k) {
      const Range range = m.limits[static_cast<std::size_t>(k)];
      const double q = state.q[m.q0 + 7 + k];
      state.at_limit[static_cast<std::size_t>(m.limit0 + k)] =
          static_cast<std::int8_t>(q <= range.min ? -1 : (q >= range.max ? 1 : 0));
    }
}

ParameterValues<double> Model::values(const State& state, int part) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  if (m.q0 < 0) return m.part->parameters().rest();
  const VecMax<double> q_s = state.q.segment(m.q0 + 7, m.n_s), q_s_dot = state.v.segment(m.v0 + 6, m.n_s);
  return m.part->parameters().expand<double>(q_s, q_s_dot);
}

Vec3<double> Model::position(const State& state, int part, double t) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  if (m.motion != nullptr) return m.motion->position.value(t);
  return m.q0 < 0 ? m.part->c0() : Vec3<double>(state.q.segment<3>(m.q0));
}

Eigen::Quaterniond Model::orientation(const State& state, int part, double t) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  if (m.motion != nullptr) return m.motion->orientation_at(t);
  if (m.q0 < 0) return m.part->R0();
  const auto theta = state.q.segment<4>(m.q0 + 3);
  return {theta[0], theta[1], theta[2], theta[3]};
}

Vec3<double> Model::world_point(const State& state, int part, const Material<double>& material) const {
  return world_point(state, part, material,
                     node_weights({parts_[static_cast<std::size_t>(part)].part, material, {}}));
}

Vec3<double> Model::world_point(const State& state, int part, const Material<double>& material,
                                const NodeWeights& at) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  Vec3<double> p = m.part->s({material}, values(state, part)).col(0);
  if (!at.node.empty()) {
    VecX<double> buffer;
    p += at_points({at}, m.local->at_nodes(state.q.data() + m.q0 + 7 + m.n_s, buffer));
  }
  return position(state, part) + orientation(state, part) * p;  // Eq. (1)
}

Nodes Model::node_positions(const State& state, int part) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  return m.part->s(m.local->mesh().nodes, values(state, part)).transpose() +
         m.local->displacements(state.q.data() + m.q0 + 7 + m.n_s);
}

double Model::energy(const SpringModel& spring, const State& state) const {
  auto position_of = [&](const PortRef& ref, const Point& point) -> Vec3<double> {
    if (ref.part < 0) return point.world.value(state.time());
    const PartModel& of = parts_[static_cast<std::size_t>(ref.part)];
    return world_point(
        state, ref.part, point.material,
        of.local == nullptr ? NodeWeights() : of.node_weights[static_cast<std::size_t>(ref.port)]);
  };
  return spring.spring->energy(position_of(spring.a, spring.spring->a),
                               position_of(spring.b, spring.spring->b));
}

double Model::gap(const State& state, int joint) const {
  const JointModel& m = joints_[static_cast<std::size_t>(joint)];
  std::array<Vec3<double>, kMaxJointPoints> x;
  for (std::size_t k = 0; k < m.at.size(); ++k) {
    const Point& point = m.joint->points()[k];
    if (point.part == nullptr) {
      x[k] = point.world.value(state.time());
      continue;
    }
    const PartModel& of = parts_[static_cast<std::size_t>(m.at[k].part)];
    x[k] = world_point(
        state, m.at[k].part, point.material,
        of.local == nullptr ? NodeWeights() : of.node_weights[static_cast<std::size_t>(m.at[k].port)]);
  }
  const VecMax<double, kMaxJointRows> C = m.joint->gap(state.time(), x.data());
  return m.joint->one_sided() ? std::max(0.0, -C[0]) : C.norm();
}

namespace {

/// Returns the part that has entry i of q or v: the part with the largest m.q0 or m.v0 that is at most i.
/// These numbers increase from part to part; fixed parts, with -1, may be between them.
const PartModel& part_with(const std::vector<PartModel>& parts, int i, int PartModel::*first) {
  std::size_t low = 0, high = parts.size();
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    std::size_t next = middle;
    while (next < high && parts[next].*first < 0) ++next;
    if (next < high && parts[next].*first <= i)
      low = next;
    else
      high = middle;
  }
  return parts[low];
}

}  // namespace

std::string Model::velocity_name(int i) const {
  static constexpr std::array<const char*, 6> rigid{"c_dot.x", "c_dot.y", "c_dot.z",
                                                    "omega.x", "omega.y", "omega.z"};
  if (i < 0 || i >= n_v()) throw std::out_of_range("no velocity number " + std::to_string(i));
  const PartModel& m = part_with(parts_, i, &PartModel::v0);
  const int k = i - m.v0;
  if (k < 6) return m.part->name() + "." + rigid[static_cast<std::size_t>(k)];
  if (k >= 6 + m.n_s) return m.part->name() + "." + m.local->coordinate_name(k - 6 - m.n_s) + "_dot";
  return m.part->name() + "." + m.part->parameters().moving(k - 6).name + "_dot";
}

std::string Model::coordinate_name(int i) const {
  static constexpr std::array<const char*, 7> rigid{"c.x",    "c.y",    "c.z",   "quat.w",
                                                    "quat.x", "quat.y", "quat.z"};
  if (i < 0 || i >= n_q()) throw std::out_of_range("no coordinate number " + std::to_string(i));
  const PartModel& m = part_with(parts_, i, &PartModel::q0);
  const int k = i - m.q0;
  if (k < 7) return m.part->name() + "." + rigid[static_cast<std::size_t>(k)];
  if (k >= 7 + m.n_s) return m.part->name() + "." + m.local->coordinate_name(k - 7 - m.n_s);
  return m.part->name() + "." + m.part->parameters().moving(k - 7).name;
}

}  // namespace pliant
