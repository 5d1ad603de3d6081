// Stage 3, loads: the values of signals and of functions of time and state. The workspace must contain the
// positions of the parts whose state is read.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <pliant/body/stages/evaluation.h>
#include <pliant/math/scalar/formula_program.h>

namespace pliant::detail {

/// Position (m) and velocity (m/s) of an attachment, world.
template <class S>
struct PortMotion {
  Vec3<S> x, x_dot;
};
template <class S>
PortMotion<S> motion_of(const Evaluation<S>& e, const PortRef& ref, const Point& point) {
  if (ref.part >= 0) {
    const PartWorkspace<S>& w = e.part_work(ref.part);
    return {w.port_x[static_cast<std::size_t>(ref.port)], w.port_x_dot[static_cast<std::size_t>(ref.port)]};
  }
  const Vec3<Taylor2<double>> x = point.world.at(e.t);
  return {Vec3<S>(S(x[0].v), S(x[1].v), S(x[2].v)), Vec3<S>(S(x[0].d), S(x[1].d), S(x[2].d))};
}

/// Marks the rows of all coordinates as unknown, at the start of an evaluation.
template <class S>
void forget_coordinates(const Evaluation<S>& e) {
  e.work.coordinates.resize(e.model().coordinates().size());
  for (CoordinateWorkspace<S>& coordinate : e.work.coordinates) coordinate.known = false;
}

/// Returns the rows C, C_dot and C_x of a coordinate; evaluates them at the first call of an evaluation.
template <class S>
const JointRows<S>& coordinate_rows(const Evaluation<S>& e, int place) {
  CoordinateWorkspace<S>& w = e.work.coordinates[static_cast<std::size_t>(place)];
  if (w.known) return w.rows;
  const CoordinateModel& m = e.model().coordinates()[static_cast<std::size_t>(place)];
  std::array<PointMotion<S>, kMaxJointPoints> x;
  for (std::size_t k = 0; k < m.at.size(); ++k) {
    const PortMotion<S> motion = motion_of(e, m.at[k], m.coordinate->points()[k]);
    x[k] = {motion.x, motion.x_dot, Vec3<S>::Constant(S(0.0))};
  }
  m.coordinate->evaluate(e.t, x.data(), w.rows);
  w.known = true;
  return w.rows;
}

template <class S>
S value_of(const Evaluation<S>& e, const FunctionModel& f);

/// Returns whether a drive acts at time t (s). A drive on a joint acts while the joint acts; a drive on a
/// parameter always acts.
inline bool acts_at(const Model& model, const DriveModel& m, double t) {
  return m.on.place < 0 || model.coordinates()[static_cast<std::size_t>(m.on.place)].coordinate->acts_at(t);
}
/// Returns whether a drive acts in an evaluation. The result depends on the mode of its joint, which is
/// constant in a step.
template <class S>
bool acts(const Evaluation<S>& e, const DriveModel& m) {
  if (m.on.place < 0) return true;
  const Joint& coordinate = *e.model().coordinates()[static_cast<std::size_t>(m.on.place)].coordinate;
  if (std::isinf(coordinate.on()) && std::isinf(coordinate.off())) return true;
  const std::vector<JointMode>* modes = nullptr;
  if (e.modes != nullptr) modes = &e.modes->joints;
  if (e.fixed_modes != nullptr) modes = &e.fixed_modes->joints.modes;
  if (modes == nullptr) return coordinate.acts_at(e.t);
  const std::vector<JointModel>& joints = e.model().joints();
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (joints[j].joint->name() == coordinate.name()) return (*modes)[j] != JointMode::off;
  return false;
}

/// Returns the difference of two values of the coordinate of a drive. If Drive::angle is true, adds a
/// multiple of 2 pi, so that the result is in [-pi, pi].
template <class S>
S coordinate_difference(const Drive& drive, const S& difference) {
  if (!drive.angle) return difference;
  return difference - S(2 * kPi * std::round(plain(difference) / (2 * kPi)));
}

/// Returns whether the ledger has the energy of a drive. The drive must be a spring and damper with constants
/// that acts at all times.
inline bool stores_energy(const Model& model, const DriveModel& m) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return m.drive->is_passive() && acts_at(model, m, -infinity) &&
         (m.on.place < 0 ||
          model.coordinates()[static_cast<std::size_t>(m.on.place)].coordinate->off() == infinity);
}

/// Returns the distance of the two points of a signal, m, and its rate.
template <class S>
std::array<S, 2> distance_of(const Evaluation<S>& e, const SignalModel& m) {
  const PortMotion<S> a = motion_of(e, m.a, m.signal->a), b = motion_of(e, m.b, m.signal->b);
  const Vec3<S> d = b.x - a.x, d_dot = b.x_dot - a.x_dot;
  const S length2 = d.dot(d);
  if (plain(length2) == 0) return {S(0.0), S(0.0)};  // d has no direction
  const S length = math::sqrt(length2);
  return {length, S(d.dot(d_dot)) / length};
}

/// Returns the velocity (m/s, world) and the angular velocity (rad/s, body frame) of the frame of a part.
template <class S>
std::array<Vec3<S>, 2> frame_velocity(const Evaluation<S>& e, int part) {
  const PartModel& m = e.part(part);
  const PartWorkspace<S>& w = e.part_work(part);
  if (m.q0 >= 0) return {w.R * w.v_r.template head<3>(), w.v_r.template segment<3>(3)};
  if (m.motion == nullptr) return {Vec3<S>::Constant(S(0.0)), Vec3<S>::Constant(S(0.0))};
  const MovingFrame frame = m.motion->at(e.t);
  return {frame.c_dot.template cast<S>(), Vec3<double>(frame.R.transpose() * frame.omega).template cast<S>()};
}

/// Returns the value of a dynamic parameter of a part, and its rate. k: its place in q_s. A part without
/// coordinates has its rest values of time 0.
template <class S>
std::array<S, 2> parameter_of(const Evaluation<S>& e, int part, int k) {
  const PartModel& m = e.part(part);
  const PartWorkspace<S>& w = e.part_work(part);
  if (m.q0 >= 0) return {w.q_s[k], w.q_s_dot[k]};
  return {S(m.part->parameters().moving(k).rest_value()), S(0.0)};
}

/// Returns the value of a signal.
template <class S>
S signal_value(const Evaluation<S>& e, const SignalModel& m) {
  using Kind = Signal::Kind;
  const int i = m.signal->index;
  switch (m.signal->kind) {
    case Kind::position:
      return e.part_work(m.part).c[i];
    case Kind::velocity:
      return frame_velocity(e, m.part)[0][i];
    case Kind::angular_velocity:
      return frame_velocity(e, m.part)[1][i];
    case Kind::parameter:
      return parameter_of(e, m.part, i)[0];
    case Kind::parameter_rate:
      return parameter_of(e, m.part, i)[1];
    case Kind::point:
      return motion_of(e, m.a, m.signal->a).x[i];
    case Kind::point_rate:
      return motion_of(e, m.a, m.signal->a).x_dot[i];
    case Kind::distance:
      return distance_of(e, m)[0];
    case Kind::distance_rate:
      return distance_of(e, m)[1];
    case Kind::coordinate:
      return coordinate_rows(e, m.place).C[i];
    case Kind::coordinate_rate:
      return coordinate_rows(e, m.place).C_dot[i];
    case Kind::sensor:
      return value_of(e, e.model().sensors()[static_cast<std::size_t>(m.place)]);
    case Kind::input:
      return S(e.work.inputs[i]);
    case Kind::at_point:
      break;  // distributed/force_at_points.h has the values at points
  }
  return S(0.0);
}

/// Returns the rate of a signal of kind coordinate or parameter.
template <class S>
S signal_rate(const Evaluation<S>& e, const SignalModel& m) {
  return m.place >= 0 ? coordinate_rows(e, m.place).C_dot[m.signal->index]
                      : parameter_of(e, m.part, m.signal->index)[1];
}

/// Returns the value of a function of time and state.
template <class S>
S value_of(const Evaluation<S>& e, const FunctionModel& f) {
  if (!f.function->reads_state()) return S(f.function->of_time().value(e.t));
  std::array<S, kMaxSignals> values;
  for (std::size_t k = 0; k < f.signals.size(); ++k) values[k] = signal_value(e, f.signals[k]);
  return f.function->formula().template value<S>(S(e.t), values.data());
}

/// Returns the three values of a vector. components: empty if the vector does not read the state.
template <class S>
Vec3<S> vector_of(const Evaluation<S>& e, const StateVector& vector,
                  const std::vector<FunctionModel>& components) {
  Vec3<S> value;
  for (std::size_t k = 0; k < 3; ++k)
    value[static_cast<Eigen::Index>(k)] =
        components.empty() ? S(vector.component[k].of_time().value(e.t)) : value_of(e, components[k]);
  return value;
}

}  // namespace pliant::detail
