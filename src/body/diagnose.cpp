// Which term of an evaluation is not a number, in the order in which the terms come about.
#include <cmath>
#include <string>

#include <pliant/body/dynamics.h>

namespace pliant {

namespace {
/// Which of the forces of a part alone is not finite.
std::string own_term(double t, const PartModel& m, const PartWorkspace<double>& w) {
  const Part& part = *m.part;
  const VecMax<double> stretch = w.q_s - m.rest_at(t);
  const VecMax<double> elastic = part.K_s() * stretch, momentum = mass_matrix(w) * w.v_r;
  const VecMax<double> damping =
      (part.alpha() * mass_matrix(w).bottomRightCorner(m.n_s, m.n_s) + part.beta() * part.K_s()) * w.q_s_dot;
  if (part.continuum() != nullptr && !std::isfinite(part.continuum()->energy(part, w.q_s)))
    return "the strain energy of its material";
  if (!elastic.allFinite()) return "the elastic force K_s (q - rest)";
  if (!damping.allFinite()) return "the damping force D q_dot";
  if (part.drag() > 0 && !(part.drag() * momentum).allFinite()) return "the drag";
  return "the sum of the forces";
}
}  // namespace

std::string Dynamics::diagnose(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                               Workspace<double>& work) const {
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (!std::isfinite(q[i])) return "the coordinate " + model_->coordinate_name(static_cast<int>(i));
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (!std::isfinite(v[i])) return "the velocity " + model_->velocity_name(static_cast<int>(i));
  accelerations(t, q, v, modes, work);
  auto of_part = [&](std::size_t i) { return " of part '" + model_->parts()[i].part->name() + "'"; };
  for (std::size_t i = 0; i < work.parts.size(); ++i) {
    if (!work.parts[i].c.allFinite() || !work.parts[i].R.allFinite())
      return "the prescribed motion" + of_part(i);
    if (model_->parts()[i].q0 < 0) continue;
    if (!work.parts[i].inertia.M.allFinite()) return "the mass matrix M" + of_part(i);
    if (work.parts[i].local && !work.parts[i].local->force.allFinite())
      return "the force on the nodes" + of_part(i);
    if (!work.parts[i].local && !work.parts[i].inertia.g_q.allFinite())
      return "the inertial force g_q" + of_part(i);
  }
  for (const PartModel& m : model_->parts())
    for (const int k : m.part->parameters().dynamic()) {
      const Parameter& p = m.part->parameters()[k];
      if (!std::isfinite(p.rest.value(t))) return "the rest value of " + m.part->name() + "." + p.name;
    }
  for (const SpringModel& s : model_->springs())
    for (const Point* end : {&s.spring->a, &s.spring->b})
      if (end->part == nullptr && !end->world.value(t).allFinite())
        return "the anchor of spring '" + s.spring->name + "'";
  for (const SpringModel& s : model_->springs())
    for (const PortRef& ref : {s.a, s.b})
      if (ref.part >= 0 && !work.parts[static_cast<std::size_t>(ref.part)]
                                .port_force[static_cast<std::size_t>(ref.port)]
                                .allFinite())
        return "the force of spring '" + s.spring->name + "'";
  for (const ForceModel& f : model_->forces())
    if (!work.parts[static_cast<std::size_t>(f.at.part)]
             .port_force[static_cast<std::size_t>(f.at.port)]
             .allFinite())
      return "the force '" + f.force->name + "'";
  for (const TorqueModel& m : model_->torques())
    if (!m.torque->torque.value(t).allFinite()) return "the torque '" + m.torque->name + "'";
  for (const JointModel& m : model_->joints()) {
    const std::string what = std::string(" of ") + m.joint->type() + " '" + m.joint->name() + "'";
    for (const Point& point : m.joint->points())
      if (point.part == nullptr && !point.world.value(t).allFinite()) return "the anchor" + what;
    if (!work.joints.C.segment(m.row, m.rows).allFinite()) return "the gap C" + what;
    if (!work.joints.C_dot.segment(m.row, m.rows).allFinite()) return "the rate C_dot" + what;
  }
  for (std::size_t i = 0; i < work.parts.size(); ++i) {
    if (model_->parts()[i].q0 < 0) continue;
    if (!work.parts[i].f.allFinite()) return own_term(t, model_->parts()[i], work.parts[i]) + of_part(i);
    if (!work.parts[i].a_r.allFinite() && model_->parts()[i].island < 0)
      return "the acceleration" + of_part(i);
  }
  for (const JointModel& m : model_->joints())
    if (!work.joints.lambda.segment(m.row, m.rows).allFinite())
      return std::string("the force of ") + m.joint->type() + " '" + m.joint->name() + "'";
  return {};
}

}  // namespace pliant
