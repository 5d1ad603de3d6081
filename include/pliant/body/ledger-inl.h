// Energies and momenta of a state, for the energy ledger.
#pragma once

#include <algorithm>

#include <pliant/body/dynamics.h>
#include <pliant/body/stages/part_stages.h>
#include <pliant/body/stages/signals.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE void Dynamics::add_energy(double t, const PartModel& m, const PartWorkspace<double>& w,
                                        Ledger& ledger) const {
  const Vec3<double> g = model_->body().gravity_at(t);
  if (m.local != nullptr) {
    const LocalMotion motion = detail::local_motion(m, w);
    ledger.kinetic += motion.kinetic;
    ledger.local += motion.elastic;
    ledger.gravity -= g.dot(m.part->total_mass() * w.c + w.R * motion.moment);
  } else {
    ledger.kinetic += 0.5 * w.v_r.dot(w.M() * w.v_r);
    ledger.gravity -= g.dot(w.inertia.mass * w.c + w.R * w.inertia.moment);
  }
  const VecMax<double> stretch = w.q_s - m.rest_at(t);
  ledger.elastic += 0.5 * stretch.dot(m.part->K_s() * stretch);
  if (m.part->continuum() != nullptr)
    ledger.elastic +=
        with_name_of_part(m.part->name(), [&] { return m.part->continuum()->energy(*m.part, w.q_s); });
}

PLIANT_INLINE void Dynamics::add_energy(double t, const SpringModel& s, const Workspace<double>& work,
                                        Ledger& ledger) const {
  auto position = [&](const PortRef& ref, const Point& point) -> Vec3<double> {
    return ref.part >= 0
               ? work.parts[static_cast<std::size_t>(ref.part)].port_x[static_cast<std::size_t>(ref.port)]
               : point.world.value(t);
  };
  if (!s.spring->acts_at(t)) return;
  ledger.springs += s.spring->energy(position(s.a, s.spring->a), position(s.b, s.spring->b));
}

PLIANT_INLINE void Dynamics::add_energy(const DriveModel& m, const Evaluation<double>& e,
                                        Ledger& ledger) const {
  if (!detail::stores_energy(*model_, m)) return;
  const double error =
      detail::coordinate_difference(*m.drive, m.drive->target.constant() - detail::signal_value(e, m.on));
  ledger.springs += 0.5 * m.drive->stiffness.constant() * error * error;
}

PLIANT_INLINE double Dynamics::energy(double t, const VecX<double>& q, const VecX<double>& v,
                                      const std::vector<int>& parts, Workspace<double>& work) const {
  Ledger ledger;
  for (const int i : parts) {
    evaluate_frame(t, q, v, i, work);
    add_energy(t, model_->parts()[static_cast<std::size_t>(i)], work.parts[static_cast<std::size_t>(i)],
               ledger);
  }
  auto is_listed = [&](const PortRef& ref) {
    return std::find(parts.begin(), parts.end(), ref.part) != parts.end();
  };
  for (const SpringModel& spring : model_->springs()) {
    if (!is_listed(spring.a) && !is_listed(spring.b)) continue;
    for (const PortRef& ref : {spring.a, spring.b})
      if (ref.part >= 0 && !is_listed(ref))
        detail::evaluate_positions<double>(model_->parts()[static_cast<std::size_t>(ref.part)], t, q, v,
                                           work.parts[static_cast<std::size_t>(ref.part)]);
    add_energy(t, spring, work, ledger);
  }
  if (model_->drives().empty()) return ledger.energy();
  const Evaluation<double> e{*this, t, q, v, work};
  detail::forget_coordinates(e);
  for (const DriveModel& drive : model_->drives()) {
    std::vector<int> read;
    model_->append_parts(drive.on, read);
    if (std::none_of(read.begin(), read.end(), [&](int i) { return is_listed({i, 0}); })) continue;
    for (const int i : read)
      if (i >= 0 && !is_listed({i, 0}))
        detail::evaluate_positions<double>(model_->parts()[static_cast<std::size_t>(i)], t, q, v,
                                           work.parts[static_cast<std::size_t>(i)]);
    add_energy(drive, e, ledger);
  }
  return ledger.energy();
}

PLIANT_INLINE Ledger Dynamics::ledger(double t, const State& state, Workspace<double>& work) const {
  accelerations(t, state.q, state.v, state, work);
  Ledger ledger;
  ledger.work = state.work;
  for (std::size_t i = 0; i < work.parts.size(); ++i) {
    const PartModel& m = model_->parts()[i];
    if (m.q0 < 0) continue;
    const PartWorkspace<double>& w = work.parts[i];
    add_energy(t, m, w, ledger);
    VecMax<double> momentum;  // linear and angular momentum about c, body frame
    if (m.local != nullptr) {
      const LocalMotion motion = detail::local_motion(m, w);
      momentum.resize(6);
      momentum << motion.momentum, motion.angular_momentum;
    } else {
      momentum = w.M() * w.v_r;
    }
    const Vec3<double> P = w.R * momentum.head<3>();
    ledger.momentum += P;
    ledger.angular_momentum += w.c.cross(P) + w.R * momentum.segment<3>(3);
  }
  for (const SpringModel& spring : model_->springs()) add_energy(t, spring, work, ledger);
  for (const DriveModel& drive : model_->drives())
    add_energy(drive, {*this, t, state.q, state.v, work}, ledger);
  return ledger;
}

PLIANT_INLINE VecX<double> Dynamics::sensor_values(double t, const State& state,
                                                   Workspace<double>& work) const {
  const Evaluation<double> e{*this, t, state.q, state.v, work};
  VecX<double> values(static_cast<Eigen::Index>(model_->sensors().size()));
  for (std::size_t k = 0; k < model_->sensors().size(); ++k)
    values[static_cast<Eigen::Index>(k)] = detail::value_of(e, model_->sensors()[k]);
  return values;
}

}  // namespace pliant
