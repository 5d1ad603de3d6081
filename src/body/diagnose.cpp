// The search for a term of an evaluation that is not finite. TermCheck::first_bad_term() defines the order:
// each term is checked after the terms from which it is computed.
#include <cmath>
#include <string>

#include <pliant/body/dynamics.h>
#include <pliant/body/stages/loads.h>

namespace pliant {

namespace {

/// The terms of one evaluation. Each function returns the name of the first term that is not finite, or an
/// empty text.
class TermCheck {
 public:
  explicit TermCheck(const Evaluation<double>& evaluation)
      : evaluation_(evaluation), model_(evaluation.model()), t_(evaluation.t), work_(evaluation.work) {}

  std::string first_bad_term() const {
    for (const auto check : {&TermCheck::masses, &TermCheck::loads, &TermCheck::joints, &TermCheck::forces,
                             &TermCheck::joint_forces})
      if (const std::string term = (this->*check)(); !term.empty()) return term;
    return {};
  }

 private:
  /// Stages 1 and 2: prescribed motions, mass, inertial forces.
  std::string masses() const {
    for (std::size_t i = 0; i < work_.parts.size(); ++i) {
      const PartWorkspace<double>& w = work_.parts[i];
      if (!w.c.allFinite() || !w.R.allFinite())
        return (model_.parts()[i].motion != nullptr ? "the prescribed motion" : "the rotation matrix") +
               of_part(i);
      if (model_.parts()[i].q0 < 0) continue;
      if (!w.M().allFinite()) return "the mass matrix M" + of_part(i);
      if (!w.local && !w.inertia.g_q.allFinite()) return "the inertial force g_q" + of_part(i);
    }
    return {};
  }
  /// Stage 3: rest values and loads.
  std::string loads() const {
    for (const PartModel& m : model_.parts())
      for (const int k : m.part->parameters().dynamic()) {
        const Parameter& p = m.part->parameters()[k];
        if (!std::isfinite(p.rest.value(t_))) return "the rest value of " + m.part->name() + "." + p.name;
      }
    for (const SpringModel& s : model_.springs())
      for (const Point* end : {&s.spring->a, &s.spring->b})
        if (end->part == nullptr && !end->world.value(t_).allFinite())
          return "the anchor of spring '" + s.spring->name + "'";
    for (const SpringModel& s : model_.springs())
      for (const PortRef& ref : {s.a, s.b})
        if (ref.part >= 0 && !force_at(ref).allFinite())
          return "the force of spring '" + s.spring->name + "'";
    for (const ForceModel& f : model_.forces())
      if (!force_at(f.at).allFinite()) return "the force '" + f.force->name + "'";
    for (const DistributedModel& m : model_.distributed_forces())
      for (Eigen::Index k = 0; k < m.X.cols(); ++k)
        if (!force_at({m.part, m.first_port + static_cast<int>(k)}).allFinite())
          return "the distributed force '" + m.force->name + "'";
    for (const TorqueModel& m : model_.torques())
      if (!detail::torque_of(evaluation_, m).allFinite()) return "the torque '" + m.torque->name + "'";
    for (const DriveModel& m : model_.drives()) {
      const auto force = detail::force_of(evaluation_, m, detail::signal_value(evaluation_, m.on),
                                          detail::signal_rate(evaluation_, m.on));
      if (!std::isfinite(force.elastic + force.damping)) return "the force of drive '" + m.drive->name + "'";
    }
    return {};
  }
  /// Stage 4: the rows of the joints.
  std::string joints() const {
    for (const JointModel& m : model_.joints()) {
      for (const Point& point : m.joint->points())
        if (point.part == nullptr && !point.world.value(t_).allFinite()) return "the anchor of " + name_of(m);
      if (!work_.joints.C.segment(m.row, m.rows).allFinite()) return "the gap C of " + name_of(m);
      if (!work_.joints.C_dot.segment(m.row, m.rows).allFinite()) return "the rate C_dot of " + name_of(m);
    }
    return {};
  }
  /// Stages 3 and 5: forces and accelerations of the parts.
  std::string forces() const {
    for (std::size_t i = 0; i < work_.parts.size(); ++i) {
      const PartModel& m = model_.parts()[i];
      if (m.q0 < 0) continue;
      if (const auto& local = work_.parts[i].local; local && !local->force.allFinite())
        return "the force on the local coordinates" + of_part(i);
      if (!work_.parts[i].f.allFinite()) return own_force(m, work_.parts[i]) + of_part(i);
      if (!work_.parts[i].a_r.allFinite() && m.island < 0) return "the acceleration" + of_part(i);
    }
    return {};
  }
  /// Stage 4: lambda.
  std::string joint_forces() const {
    for (const JointModel& m : model_.joints())
      if (!work_.joints.lambda.segment(m.row, m.rows).allFinite()) return "the force of " + name_of(m);
    return {};
  }

  /// Returns the name of the first force of a part that is not finite. Loads are not checked.
  std::string own_force(const PartModel& m, const PartWorkspace<double>& w) const {
    const Part& part = *m.part;
    const VecMax<double> stretch = w.q_s - m.rest_at(t_);
    const VecMax<double> elastic = part.K_s() * stretch, momentum = mass_matrix(w) * w.v_r;
    const VecMax<double> damping =
        (part.alpha() * mass_matrix(w).bottomRightCorner(m.n_s, m.n_s) + part.beta() * part.K_s()) *
        w.q_s_dot;
    if (part.continuum() != nullptr && !std::isfinite(part.continuum()->energy(part, w.q_s)))
      return "the strain energy";
    if (!elastic.allFinite()) return "the elastic force K_s (q - rest)";
    if (!damping.allFinite()) return "the damping force D q_dot";
    if (part.drag() > 0 && !(part.drag() * momentum).allFinite()) return "the drag";
    return "the sum of the forces";
  }
  std::string of_part(std::size_t i) const { return " of part '" + model_.parts()[i].part->name() + "'"; }
  static std::string name_of(const JointModel& m) {
    return std::string(m.joint->type()) + " '" + m.joint->name() + "'";
  }
  const Vec3<double>& force_at(const PortRef& ref) const {
    return work_.parts[static_cast<std::size_t>(ref.part)].port_force[static_cast<std::size_t>(ref.port)];
  }

  const Evaluation<double>& evaluation_;
  const Model& model_;
  double t_;
  const Workspace<double>& work_;
};

}  // namespace

std::string Dynamics::diagnose(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                               Workspace<double>& work) const {
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (!std::isfinite(q[i])) return "the coordinate " + model_->coordinate_name(static_cast<int>(i));
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (!std::isfinite(v[i])) return "the velocity " + model_->velocity_name(static_cast<int>(i));
  accelerations(t, q, v, modes, work);
  const Evaluation<double> evaluation{*this, t, q, v, work, &modes};
  return TermCheck(evaluation).first_bad_term();
}

}  // namespace pliant
