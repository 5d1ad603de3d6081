#include <pliant/view/forces.h>

#include <pliant/body/placed_point.h>
#include <pliant/body/stages/loads.h>
#include <pliant/contact/contact_stepping.h>

namespace pliant {

std::vector<ForceArrow> contact_forces(const Simulation& simulation) {
  std::vector<ForceArrow> arrows;
  if (simulation.contact() == nullptr) return arrows;
  const ContactRecord& record = simulation.contact()->record();
  for (std::size_t i = 0; i < record.impulses.size(); ++i)
    if (record.time[i] > 0) arrows.push_back({record.contacts[i].x, record.impulses[i] / record.time[i]});
  return arrows;
}

std::vector<ForceArrow> joint_forces(const Dynamics& dynamics, const State& state) {
  std::vector<ForceArrow> arrows;
  const Model& model = dynamics.model();
  if (model.joints().empty()) return arrows;
  Workspace<double> work;
  dynamics.accelerations(state.time(), state.q, state.v, state, work);
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    if (state.joints[j] == JointMode::off) continue;
    const Vec3<double> at = PlacedPoint(model, model.joints()[j].joint->points().front()).at(state);
    arrows.push_back({at, dynamics.joint_wrench(state.time(), static_cast<int>(j), work).force});
  }
  return arrows;
}

std::vector<ForceArrow> load_forces(const Dynamics& dynamics, const State& state) {
  std::vector<ForceArrow> arrows;
  const Model& model = dynamics.model();
  if (model.loaded_parts().empty()) return arrows;
  Workspace<double> work;
  dynamics.accelerations(state.time(), state.q, state.v, state, work);
  const Evaluation<double> e{dynamics, state.time(), state.q, state.v, work, &state};
  for (const SpringModel& m : model.springs()) {
    if (!m.spring->acts_at(state.time())) continue;
    const auto a = detail::motion_of(e, m.a, m.spring->a), b = detail::motion_of(e, m.b, m.spring->b);
    const Vec3<double> pull = detail::force_of(e, m, a, b).elastic;
    if (m.a.part >= 0) arrows.push_back({a.x, pull});
    if (m.b.part >= 0) arrows.push_back({b.x, -pull});
  }
  for (const ForceModel& m : model.forces()) {
    const auto at = detail::motion_of(e, m.at, m.force->at);
    arrows.push_back({at.x, detail::force_of(e, m, at)});
  }
  for (const DistributedModel& m : model.distributed_forces()) {
    const PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(m.part)];
    Vec3<double> sum = Vec3<double>::Zero(), weighted = Vec3<double>::Zero();
    double weight = 0;
    detail::for_each_force(e, m, [&](int port, const Vec3<double>& force) {
      sum += force;
      weight += force.norm();
      weighted += force.norm() * w.port_x[static_cast<std::size_t>(port)];
    });
    if (weight > 0) arrows.push_back({weighted / weight, sum});
  }
  return arrows;
}

}  // namespace pliant
