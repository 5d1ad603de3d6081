#include <pliant/body/model.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace pliant {

Model::Model(MultiBody& body) : body_(&body) {
  if (!body.gravity.allFinite()) throw std::invalid_argument("gravity is not finite");
  for (const auto& part : body.parts()) {
    part->prepare();
    PartModel m;
    m.part = part.get();
    m.use = part->use();
    m.n_s = part->n_s();
    m.q0 = part->fixed() ? -1 : n_q_;
    m.v0 = part->fixed() ? -1 : n_v_;
    m.limit0 = n_limits_;
    m.R0 = part->R0().toRotationMatrix();
    n_q_ += part->n_q();
    n_v_ += part->n_v();
    n_limits_ += m.n_s;

    // Below this a diagonal entry of M counts as no inertia: rounding noise of a body of this mass and size.
    const double mass = part->total_mass(), size = part->size();
    m.inertia_floor = VecMax<double>::Zero(6 + m.n_s);
    for (int k = 0; k < m.n_s; ++k) {
      const Parameter& p = part->parameters().moving(k);
      m.inertia_floor[6 + k] = 1e-24 * mass * (p.spec->quantity == Quantity::length ? 1.0 : size * size);
    }
    if (part->rigid()) m.rigid_factor.compute(part->rest_inertia().M, m.inertia_floor);
    parts_.push_back(std::move(m));
  }
  for (const auto& spring : body.springs()) {
    const std::string what = "spring '" + spring->name + "'";
    SpringModel m{spring.get(), attach(spring->a, what), attach(spring->b, what)};
    if (m.a.part < 0 && m.b.part < 0) throw std::invalid_argument(what + " ties the world to itself");
    springs_.push_back(m);
  }
  for (const auto& force : body.forces()) {
    if (force->at.part == nullptr) throw std::invalid_argument("force '" + force->name + "' acts on no part");
    forces_.push_back({force.get(), attach(force->at, "force '" + force->name + "'")});
  }
  for (const auto& torque : body.torques()) {
    if (torque->part == nullptr) throw std::invalid_argument("torque '" + torque->name + "' acts on no part");
    torques_.push_back({torque.get(), body.index(*torque->part)});
  }
  Counters unused;
  for (PartModel& m : parts_)
    if (m.part->rigid() && !m.ports.empty())
      m.part->points(m.ports, VecMax<double>(0), VecMax<double>(0), m.rigid_ports, unused);
}

PortRef Model::attach(const Point& point, const std::string& what) {
  if (point.part == nullptr) return {};
  const Material<double>& m = point.material;
  if (!(m.w >= 0 && m.w <= 1) || std::isnan(m.cu.x + m.su.x + m.cv.x + m.sv.x))
    throw std::invalid_argument(
        what + ": its point on part '" + point.part->name() +
        "' needs angles that are numbers, and w from 0 at the centre to 1 on the surface");
  const int part = body_->index(*point.part);
  auto& ports = parts_[static_cast<std::size_t>(part)].ports;
  ports.push_back(point.material);
  return {part, static_cast<int>(ports.size()) - 1};
}

State Model::initial_state() const {
  State state;
  state.q.setZero(n_q_);
  state.v.setZero(n_v_);
  state.at_limit.assign(static_cast<std::size_t>(n_limits_), 0);
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
      std::int8_t& at = state.at_limit[static_cast<std::size_t>(m.limit0 + k)];
      if (p.initial <= p.limits.min) at = -1;
      if (p.initial >= p.limits.max) at = 1;
    }
  }
  return state;
}

ParameterValues<double> Model::values(const State& state, int part) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  if (m.q0 < 0) return m.part->parameters().rest();
  const VecMax<double> q_s = state.q.segment(m.q0 + 7, m.n_s), q_s_dot = state.v.segment(m.v0 + 6, m.n_s);
  return m.part->parameters().expand<double>(q_s, q_s_dot);
}

Vec3<double> Model::position(const State& state, int part) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  return m.q0 < 0 ? m.part->c0() : Vec3<double>(state.q.segment<3>(m.q0));
}

Eigen::Quaterniond Model::orientation(const State& state, int part) const {
  const PartModel& m = parts_[static_cast<std::size_t>(part)];
  if (m.q0 < 0) return m.part->R0();
  const auto theta = state.q.segment<4>(m.q0 + 3);
  return {theta[0], theta[1], theta[2], theta[3]};
}

Vec3<double> Model::world_point(const State& state, int part, const Material<double>& material) const {
  const Part& p = *parts_[static_cast<std::size_t>(part)].part;
  const Vec3<double> s = p.s({material}, values(state, part)).col(0);
  return position(state, part) + orientation(state, part) * s;  // Eq. (1)
}

std::string Model::velocity_name(int i) const {
  static constexpr std::array<const char*, 6> rigid{"c_dot.x", "c_dot.y", "c_dot.z",
                                                    "omega.x", "omega.y", "omega.z"};
  for (const PartModel& m : parts_) {
    if (m.v0 < 0 || i < m.v0 || i >= m.v0 + 6 + m.n_s) continue;
    const int k = i - m.v0;
    if (k < 6) return m.part->name() + "." + rigid[static_cast<std::size_t>(k)];
    return m.part->name() + "." + m.part->parameters().moving(k - 6).name + "_dot";
  }
  throw std::out_of_range("no velocity number " + std::to_string(i));
}

std::string Model::coordinate_name(int i) const {
  static constexpr std::array<const char*, 7> rigid{"c.x",    "c.y",    "c.z",   "quat.w",
                                                    "quat.x", "quat.y", "quat.z"};
  for (const PartModel& m : parts_) {
    if (m.q0 < 0 || i < m.q0 || i >= m.q0 + 7 + m.n_s) continue;
    const int k = i - m.q0;
    if (k < 7) return m.part->name() + "." + rigid[static_cast<std::size_t>(k)];
    return m.part->name() + "." + m.part->parameters().moving(k - 7).name;
  }
  throw std::out_of_range("no coordinate number " + std::to_string(i));
}

}  // namespace pliant
