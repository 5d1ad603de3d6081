// Function bodies of load_work.h: the work of loads during a displacement. Their forces are evaluated at the
// end of the displacement.
#pragma once

#include <pliant/contact/load_work.h>

#include <algorithm>

#include <pliant/body/stages/loads.h>
#include <pliant/body/stages/part_stages.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

namespace load_work {

inline bool has_actuation(const Model& model, const DriveModel& m) {
  return !detail::stores_energy(model, m);
}
inline bool has_actuation(const SpringModel& m) {
  return !m.functions.empty();
}

}  // namespace load_work

PLIANT_INLINE LoadWork::LoadWork(const Dynamics& dynamics, const State& from) : dynamics_(dynamics) {
  const Model& model = dynamics.model();
  auto read = [&](const std::vector<FunctionModel>& functions) {
    for (const FunctionModel& function : functions) model.append_parts(function, loaded_);
  };
  for (const ForceModel& f : model.forces()) {
    loaded_.push_back(f.at.part);
    read(f.components);
  }
  for (const TorqueModel& m : model.torques()) {
    loaded_.insert(loaded_.end(), {m.part, m.against});
    read(m.components);
  }
  for (const DistributedModel& m : model.distributed_forces()) {
    loaded_.push_back(m.part);
    read({m.density[0], m.density[1], m.density[2], m.pressure});
  }
  for (const SpringModel& s : model.springs())
    if (load_work::has_actuation(s)) {
      loaded_.insert(loaded_.end(), {s.a.part, s.b.part});
      read(s.functions);
    }
  for (const DriveModel& m : model.drives())
    if (load_work::has_actuation(model, m)) {
      model.append_parts(m.on, loaded_);
      read({m.target, m.target_rate, m.stiffness, m.damping, m.force});
    }
  std::sort(loaded_.begin(), loaded_.end());
  loaded_.erase(std::unique(loaded_.begin(), loaded_.end()), loaded_.end());
  loaded_.erase(std::remove(loaded_.begin(), loaded_.end(), -1), loaded_.end());
  if (loaded_.empty()) return;
  const Evaluation<double> e = evaluate(from.time(), from);
  before_ = places(e);
}

PLIANT_INLINE Evaluation<double> LoadWork::evaluate(double t, const State& state) {
  const Model& model = dynamics_.model();
  const Evaluation<double> e{dynamics_, t, state.q, state.v, work_};
  detail::forget_coordinates(e);
  work_.inputs = state.inputs;
  work_.parts.resize(model.parts().size());
  for (const int i : loaded_)
    if (model.parts()[at(i)].q0 >= 0)
      dynamics_.evaluate_frame(t, state.q, state.v, i, work_);
    else
      detail::evaluate_positions<double>(model.parts()[at(i)], t, state.q, state.v, work_.parts[at(i)]);
  return e;
}

PLIANT_INLINE LoadWork::Places LoadWork::places(const Evaluation<double>& e) const {
  const Model& model = dynamics_.model();
  Places places;
  for (const ForceModel& f : model.forces())
    places.forces.push_back(detail::motion_of(e, f.at, f.force->at).x);
  for (const DistributedModel& m : model.distributed_forces()) {
    const auto first = e.part_work(m.part).port_x.begin() + m.first_port;
    places.distributed.emplace_back(first, first + m.X.cols());
  }
  for (const TorqueModel& m : model.torques())
    for (const int part : {m.part, m.against})
      places.rotations.push_back(part < 0 ? Mat3<double>::Identity() : e.part_work(part).R);
  for (const SpringModel& s : model.springs())
    if (load_work::has_actuation(s))
      places.springs.push_back(detail::motion_of(e, s.b, s.spring->b).x -
                               detail::motion_of(e, s.a, s.spring->a).x);
  for (const DriveModel& m : model.drives())
    if (load_work::has_actuation(model, m)) places.drives.push_back(detail::signal_value(e, m.on));
  return places;
}

PLIANT_INLINE double LoadWork::work_until(double t, const State& to) {
  if (loaded_.empty()) return 0;
  const Model& model = dynamics_.model();
  const Evaluation<double> e = evaluate(t, to);
  const Places after = places(e);
  double work = 0;
  for (std::size_t k = 0; k < model.forces().size(); ++k) {
    const ForceModel& f = model.forces()[k];
    if (model.parts()[at(f.at.part)].q0 < 0) continue;
    const Vec3<double> force = detail::force_of(e, f, detail::motion_of(e, f.at, f.force->at));
    work += force.dot(after.forces[k] - before_.forces[k]);
  }
  for (std::size_t k = 0; k < model.distributed_forces().size(); ++k) {
    const DistributedModel& m = model.distributed_forces()[k];
    detail::for_each_force(e, m, [&](int port, const Vec3<double>& force) {
      const auto place = at(port - m.first_port);
      work += force.dot(after.distributed[k][place] - before_.distributed[k][place]);
    });
  }
  for (std::size_t k = 0; k < model.torques().size(); ++k) {
    const TorqueModel& m = model.torques()[k];
    Vec3<double> torque = detail::torque_of(e, m);
    if (m.torque->frame == Frame::body) torque = (e.part_work(m.part).R * torque).eval();
    const int sides[] = {m.part, m.against};
    for (std::size_t side = 0; side < 2; ++side) {
      if (sides[side] < 0 || model.parts()[at(sides[side])].q0 < 0) continue;
      const Mat3<double> turn = after.rotations[2 * k + side] * before_.rotations[2 * k + side].transpose();
      work += (side == 0 ? 1 : -1) * torque.dot(rotation_vector<double>(turn));
    }
  }
  std::size_t spring = 0, drive = 0;
  for (const SpringModel& s : model.springs()) {
    if (!load_work::has_actuation(s)) continue;
    const Vec3<double> change = after.springs[spring] - before_.springs[spring];
    ++spring;
    if (!s.spring->acts_at(t)) continue;
    const detail::PortMotion<double> a = detail::motion_of(e, s.a, s.spring->a),
                                     b = detail::motion_of(e, s.b, s.spring->b);
    work -= detail::force_of(e, s, a, b).elastic.dot(change);
  }
  for (const DriveModel& m : model.drives()) {
    if (!load_work::has_actuation(model, m)) continue;
    const double x = after.drives[drive];
    const double change = detail::coordinate_difference(*m.drive, x - before_.drives[drive]);
    ++drive;
    if (!detail::acts_at(model, m, t)) continue;
    const detail::DriveForce<double> f = detail::force_of(e, m, x, detail::signal_rate(e, m.on));
    work += (f.elastic + f.damping) * change;
  }
  return work;
}

}  // namespace pliant
