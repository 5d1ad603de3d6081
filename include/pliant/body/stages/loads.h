// Stage 3, loads: the forces of springs, the forces at points, the distributed forces, the torques and the
// drives, with their powers.
// Forces are gathered at the ports of the parts; part_stages.h turns them into f_q = L^T f, Eq. (11).
#pragma once

#include <pliant/body/distributed/force_at_points.h>
#include <pliant/body/stages/evaluation.h>
#include <pliant/body/stages/signals.h>

namespace pliant::detail {

/// Returns the force of a point force, N, world. at: position and velocity of the point at which it acts.
template <class S>
Vec3<S> force_of(const Evaluation<S>& e, const ForceModel& f, const PortMotion<S>& at) {
  const PointForce& force = *f.force;
  if (force.custom) {
    Vec3<double> x, x_dot;
    for (int r = 0; r < 3; ++r) {
      x[r] = plain(at.x[r]);
      x_dot[r] = plain(at.x_dot[r]);
    }
    return force.custom(e.t, x, x_dot).template cast<S>();
  }
  const Vec3<S> value = vector_of(e, force.force, f.components);
  return force.frame == Frame::body ? Vec3<S>(e.part_work(f.at.part).R * value) : value;
}

/// The elastic and the damping force of a spring on its end a, N, world. Both are zero if the ends coincide
/// and the rest length is not the constant 0: the spring then has no direction.
template <class S>
struct SpringForce {
  Vec3<S> elastic, damping;
};
template <class S>
SpringForce<S> force_of(const Evaluation<S>& e, const SpringModel& s, const PortMotion<S>& a,
                        const PortMotion<S>& b) {
  const Spring& spring = *s.spring;
  auto number = [&](std::size_t k, const StateFunction& function) {
    return s.functions.empty() ? S(function.constant()) : value_of(e, s.functions[k]);
  };
  const S stiffness = number(0, spring.stiffness), damping = number(1, spring.damping);
  const Vec3<S> d = b.x - a.x, d_dot = b.x_dot - a.x_dot;
  if (spring.rest_length.is_constant() && spring.rest_length.constant() == 0)
    return {d * stiffness, d_dot * damping};
  const S length2 = d.dot(d);
  if (plain(length2) == 0) return {Vec3<S>::Constant(S(0.0)), Vec3<S>::Constant(S(0.0))};
  const S length = math::sqrt(length2);
  const Vec3<S> along = d / length;
  return {along * S((length - number(2, spring.rest_length)) * stiffness),
          along * S(along.dot(d_dot) * damping)};
}

/// Returns the torque of a load, N m, in the frame Torque::frame.
template <class S>
Vec3<S> torque_of(const Evaluation<S>& e, const TorqueModel& m) {
  return vector_of(e, m.torque->torque, m.components);
}

/// The two terms of the force of a drive along its coordinate x, N or N m: the term of the stiffness and
/// `force`, and the term of the damping. If Drive::max_force limits their sum, both terms are scaled.
template <class S>
struct DriveForce {
  S elastic, damping;
};
template <class S>
DriveForce<S> force_of(const Evaluation<S>& e, const DriveModel& m, const S& x, const S& x_dot) {
  const Drive& drive = *m.drive;
  const S error = coordinate_difference(drive, S(value_of(e, m.target) - x));
  const S target_rate = drive.target_rate ? value_of(e, m.target_rate) : S(drive.target.of_time().at(e.t).d);
  DriveForce<S> f{value_of(e, m.stiffness) * error + value_of(e, m.force),
                  value_of(e, m.damping) * S(target_rate - x_dot)};
  const S sum = f.elastic + f.damping;
  if (const double size = std::abs(plain(sum)); size > drive.max_force) {
    const S scale = S(plain(sum) < 0 ? -drive.max_force : drive.max_force) / sum;
    f.elastic = f.elastic * scale;
    f.damping = f.damping * scale;
  }
  return f;
}

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
    for (const DistributedModel& force : model_.distributed_forces()) add(force);
    for (const DriveModel& drive : model_.drives()) add(drive);
  }

 private:
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
    const PortMotion<S> a = motion_of(e_, s.a, s.spring->a), b = motion_of(e_, s.b, s.spring->b);
    const SpringForce<S> pull = force_of(e_, s, a, b);  // on a, towards b
    const Vec3<S> force = pull.elastic + pull.damping, d_dot = b.x_dot - a.x_dot;
    push(s.a, force, 1);
    push(s.b, force, -1);
    power(Work::spring_damping) -= pull.damping.dot(d_dot);
    if (!s.functions.empty()) power(Work::actuation) -= pull.elastic.dot(d_dot);
    // The prescribed motion of an end does work against the force of the spring on this end.
    if (!moves(s.a)) power(Work::anchors) -= force.dot(a.x_dot);
    if (!moves(s.b)) power(Work::anchors) += force.dot(b.x_dot);
  }

  void add(const ForceModel& f) {
    const PortMotion<S> at = motion_of(e_, f.at, f.force->at);
    const Vec3<S> force = force_of(e_, f, at);
    push(f.at, force, 1);
    if (moves(f.at)) power(Work::forces) += force.dot(at.x_dot);
  }

  void add(const TorqueModel& m) {
    Vec3<S> torque = torque_of(e_, m);
    turn(m.part, torque, m.torque->frame);
    if (m.against < 0) return;
    if (m.torque->frame == Frame::body) torque = (e_.part_work(m.part).R * torque).eval();
    turn(m.against, -torque, Frame::world);
  }

  void add(const DistributedModel& m) {
    PartWorkspace<S>& w = e_.part_work(m.part);
    for_each_force(e_, m, [&](int port, const Vec3<S>& force) {
      w.port_force[static_cast<std::size_t>(port)] += force;
      power(Work::forces) += force.dot(w.port_x_dot[static_cast<std::size_t>(port)]);
    });
  }

  void add(const DriveModel& m) {
    if (!acts(e_, m)) return;
    const S x = signal_value(e_, m.on), x_dot = signal_rate(e_, m.on);
    const DriveForce<S> f = force_of(e_, m, x, x_dot);
    const S force = f.elastic + f.damping;
    if (m.on.place >= 0)
      push_coordinate(m.on, force);
    else if (e_.part(m.on.part).q0 >= 0)
      e_.part_work(m.on.part).f[6 + m.on.signal->index] += force;
    if (stores_energy(model_, m)) {
      power(Work::spring_damping) += f.damping * x_dot;
      return;
    }
    power(Work::actuation) += force * x_dot;
  }
  /// Adds the forces C_x^T f of a force f along a coordinate to the ports of its points. The prescribed
  /// motion of a point does work against the force on this point.
  void push_coordinate(const SignalModel& on, const S& force) {
    const JointRows<S>& rows = coordinate_rows(e_, on.place);
    const std::vector<PortRef>& at = model_.coordinates()[static_cast<std::size_t>(on.place)].at;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const Vec3<S> along =
          rows.C_x.row(on.signal->index).template segment<3>(3 * static_cast<Eigen::Index>(k)).transpose();
      push(at[k], along * force, 1);
      if (moves(at[k])) continue;
      const Point& point = model_.coordinates()[static_cast<std::size_t>(on.place)].coordinate->points()[k];
      power(Work::anchors) -= S(along.dot(motion_of(e_, at[k], point).x_dot)) * force;
    }
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

/// Returns the power of the damper of a spring, or of a drive whose energy is in the ledger, W. This power is
/// part of Work::spring_damping. The positions of the parts at the spring or drive must be in the workspace.
template <class S>
S damper_power(const Evaluation<S>& e, const SpringModel& s) {
  if (!s.spring->acts_at(e.t)) return S(0.0);
  const PortMotion<S> a = motion_of(e, s.a, s.spring->a), b = motion_of(e, s.b, s.spring->b);
  return -force_of(e, s, a, b).damping.dot(b.x_dot - a.x_dot);
}
template <class S>
S damper_power(const Evaluation<S>& e, const DriveModel& m) {
  const S x = signal_value(e, m.on), x_dot = signal_rate(e, m.on);
  return force_of(e, m, x, x_dot).damping * x_dot;
}

/// Stage 3, loads: adds the forces and torques of all loads to the parts on which they act.
template <class S>
void apply_loads(const Evaluation<S>& e) {
  LoadStage<S>(e).add_all();
}

}  // namespace pliant::detail
