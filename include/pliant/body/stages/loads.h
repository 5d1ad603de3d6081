// Stage 3, loads: the forces of springs, the forces at points and the torques, with their powers. Forces are
// gathered at the ports of the parts; part_stages.h turns them into f_q = L^T f, Eq. (11).
#pragma once

#include <pliant/body/stages/evaluation.h>

namespace pliant::detail {

/// Evaluates the loads of a model in a fixed order. The positions of all parts with loads must be in the
/// workspace.
template <class S>
class LoadStage {
 public:
  explicit LoadStage(const Evaluation<S>& e) : e_(e), model_(e.model()), power_(e.work.power) {}

  /// Adds the forces of all loads to port_force of the parts, torques to f, and their powers to work.power.
  void add_all() {
    for (const SpringModel& spring : model_.springs()) add(spring);
    for (const ForceModel& force : model_.forces()) add(force);
    for (const TorqueModel& torque : model_.torques()) add(torque);
  }

 private:
  /// Position (m) and velocity (m/s) of an end of a load, world.
  struct End {
    Vec3<S> x, x_dot;
  };

  End end_of(const PortRef& ref, const Point& point) const {
    if (ref.part >= 0) {
      const PartWorkspace<S>& w = e_.part_work(ref.part);
      return {w.port_x[static_cast<std::size_t>(ref.port)], w.port_x_dot[static_cast<std::size_t>(ref.port)]};
    }
    const Vec3<Taylor2<double>> x = point.world.at(e_.t);
    return {Vec3<S>(S(x[0].v), S(x[1].v), S(x[2].v)), Vec3<S>(S(x[0].d), S(x[1].d), S(x[2].d))};
  }
  /// Adds a force to a port. A force on the world has no effect.
  void push(const PortRef& ref, const Vec3<S>& force, double sign) {
    if (ref.part < 0) return;
    e_.part_work(ref.part).port_force[static_cast<std::size_t>(ref.port)] += force * S(sign);
  }
  /// Returns whether an end is on a part that has coordinates.
  bool moves(const PortRef& ref) const { return ref.part >= 0 && e_.part(ref.part).q0 >= 0; }
  S& power(Work kind) { return power_[static_cast<int>(kind)]; }

  void add(const SpringModel& s) {
    if (!s.spring->acts_at(e_.t)) return;
    const End a = end_of(s.a, s.spring->a), b = end_of(s.b, s.spring->b);
    const Vec3<S> d = b.x - a.x, d_dot = b.x_dot - a.x_dot;
    Vec3<S> pull, damping;  // on a, towards b
    if (s.spring->rest_length == 0) {
      pull = d * S(s.spring->stiffness);
      damping = d_dot * S(s.spring->damping);
    } else {
      const S length2 = d.dot(d);
      if (plain(length2) == 0) return;  // no direction, no force; the step reports NaN
      const S length = math::sqrt(length2);
      const Vec3<S> along = d / length;
      pull = along * S((length - s.spring->rest_length) * s.spring->stiffness);
      damping = along * S(along.dot(d_dot) * s.spring->damping);
    }
    const Vec3<S> force = pull + damping;
    push(s.a, force, 1);
    push(s.b, force, -1);
    power(Work::spring_damping) -= damping.dot(d_dot);
    // The prescribed motion of an end does work against the force of the spring on this end.
    if (!moves(s.a)) power(Work::anchors) -= force.dot(a.x_dot);
    if (!moves(s.b)) power(Work::anchors) += force.dot(b.x_dot);
  }

  void add(const ForceModel& f) {
    const End at = end_of(f.at, f.force->at);
    Vec3<S> force;
    if (f.force->custom) {
      Vec3<double> x, x_dot;
      for (int r = 0; r < 3; ++r) {
        x[r] = plain(at.x[r]);
        x_dot[r] = plain(at.x_dot[r]);
      }
      force = f.force->custom(e_.t, x, x_dot).template cast<S>();
    } else {
      force = f.force->force.value(e_.t).template cast<S>();
      if (f.force->frame == Frame::body) force = (e_.part_work(f.at.part).R * force).eval();
    }
    push(f.at, force, 1);
    if (moves(f.at)) power(Work::forces) += force.dot(at.x_dot);
  }

  void add(const TorqueModel& m) {
    Vec3<S> torque = m.torque->torque.value(e_.t).template cast<S>();
    turn(m.part, torque, m.torque->frame);
    if (m.against < 0) return;
    if (m.torque->frame == Frame::body) torque = (e_.part_work(m.part).R * torque).eval();
    turn(m.against, -torque, Frame::world);
  }
  /// Adds a torque to f of a part, and its power to work.power. A torque on a part without coordinates has no
  /// effect.
  void turn(int part, Vec3<S> torque, Frame frame) {
    PartWorkspace<S>& w = e_.part_work(part);
    if (e_.part(part).q0 < 0) return;
    if (frame == Frame::world) torque = (w.R.transpose() * torque).eval();
    w.f.template segment<3>(3) += torque;
    power(Work::forces) += torque.dot(w.v_r.template segment<3>(3));
  }

  const Evaluation<S>& e_;
  const Model& model_;
  Vec<S, kWorks>& power_;
};

/// Stage 3, loads: adds the forces of springs, points and torques to the parts they act on.
template <class S>
void apply_loads(const Evaluation<S>& e) {
  LoadStage<S>(e).add_all();
}

}  // namespace pliant::detail
