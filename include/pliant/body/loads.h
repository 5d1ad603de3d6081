// Loads on parts: springs, forces at points, torques.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Adds what they push at ports to port_force of the parts, in a fixed order, torques to f, and their powers.
/// work: with the positions of all parts that loads act on.
template <class S>
void apply_loads(const Model& model, double t, Workspace<S>& work) {
  struct WorldPoint {
    Vec3<S> x, x_dot;
  };
  const auto& parts = model.parts();
  auto at_port = [&](const PortRef& ref, const Point& point) -> WorldPoint {
    if (ref.part >= 0) {
      const PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(ref.part)];
      return {w.port_x[static_cast<std::size_t>(ref.port)], w.port_x_dot[static_cast<std::size_t>(ref.port)]};
    }
    const Vec3<Taylor2<double>> x = point.world.at(t);
    return {Vec3<S>(S(x[0].v), S(x[1].v), S(x[2].v)), Vec3<S>(S(x[0].d), S(x[1].d), S(x[2].d))};
  };
  auto push = [&](const PortRef& ref, const Vec3<S>& force, double sign) {
    if (ref.part < 0) return;
    work.parts[static_cast<std::size_t>(ref.part)].port_force[static_cast<std::size_t>(ref.port)] +=
        force * S(sign);
  };
  auto moves = [&](const PortRef& ref) {
    return ref.part >= 0 && parts[static_cast<std::size_t>(ref.part)].q0 >= 0;
  };
  for (const SpringModel& s : model.springs()) {
    const WorldPoint a = at_port(s.a, s.spring->a), b = at_port(s.b, s.spring->b);
    const Vec3<S> d = b.x - a.x, d_dot = b.x_dot - a.x_dot;
    Vec3<S> pull, damping;  // on a, towards b
    if (s.spring->rest_length == 0) {
      pull = d * S(s.spring->stiffness);
      damping = d_dot * S(s.spring->damping);
    } else {
      const S length2 = d.dot(d);
      if (plain(length2) == 0) continue;  // no direction; what is not a number goes on to be found
      const S length = math::sqrt(length2);
      const Vec3<S> along = d / length;
      pull = along * S((length - s.spring->rest_length) * s.spring->stiffness);
      damping = along * S(along.dot(d_dot) * s.spring->damping);
    }
    const Vec3<S> force = pull + damping;
    push(s.a, force, 1);
    push(s.b, force, -1);
    work.power[static_cast<int>(Work::spring_damping)] -= damping.dot(d_dot);
    // The hand that moves an anchor exerts the opposite of the spring's pull on it.
    if (!moves(s.a)) work.power[static_cast<int>(Work::anchors)] -= force.dot(a.x_dot);
    if (!moves(s.b)) work.power[static_cast<int>(Work::anchors)] += force.dot(b.x_dot);
  }
  for (const ForceModel& f : model.forces()) {
    const WorldPoint at = at_port(f.at, f.force->at);
    Vec3<S> force;
    if (f.force->custom) {
      Vec3<double> x, x_dot;
      for (int r = 0; r < 3; ++r) {
        x[r] = plain(at.x[r]);
        x_dot[r] = plain(at.x_dot[r]);
      }
      force = f.force->custom(t, x, x_dot).template cast<S>();
    } else {
      force = f.force->force.value(t).template cast<S>();
      if (f.force->frame == Frame::body)
        force = (work.parts[static_cast<std::size_t>(f.at.part)].R * force).eval();
    }
    push(f.at, force, 1);
    if (moves(f.at)) work.power[static_cast<int>(Work::forces)] += force.dot(at.x_dot);
  }
  auto turn = [&](int part, Vec3<S> torque, Frame frame) {
    PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(part)];
    if (parts[static_cast<std::size_t>(part)].q0 < 0) return;
    if (frame == Frame::world) torque = (w.R.transpose() * torque).eval();
    w.f.template segment<3>(3) += torque;
    work.power[static_cast<int>(Work::forces)] += torque.dot(w.v_r.template segment<3>(3));
  };
  for (const TorqueModel& m : model.torques()) {
    Vec3<S> torque = m.torque->torque.value(t).template cast<S>();
    turn(m.part, torque, m.torque->frame);
    if (m.against < 0) continue;
    if (m.torque->frame == Frame::body)
      torque = (work.parts[static_cast<std::size_t>(m.part)].R * torque).eval();
    turn(m.against, -torque, Frame::world);
  }
}

}  // namespace pliant
