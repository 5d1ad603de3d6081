#include <pliant/view/forces.h>

#include <pliant/body/placed_point.h>
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

std::vector<ForceArrow> joint_forces(const Simulation& simulation) {
  std::vector<ForceArrow> arrows;
  const Model& model = simulation.model();
  if (model.joints().empty()) return arrows;
  const State& state = simulation.state();
  Workspace<double> work;
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    if (state.joints[j] == JointMode::off) continue;
    const Vec3<double> at = PlacedPoint(model, model.joints()[j].joint->points().front()).at(state);
    arrows.push_back({at, simulation.dynamics().joint_wrench(state.time(), static_cast<int>(j), work).force});
  }
  return arrows;
}

std::vector<ForceArrow> load_forces(const Simulation& simulation) {
  std::vector<ForceArrow> arrows;
  const Model& model = simulation.model();
  const State& state = simulation.state();
  for (const SpringModel& m : model.springs()) {
    const Spring& spring = *m.spring;
    if (!spring.acts_at(state.time())) continue;
    const Vec3<double> a = PlacedPoint(model, spring.a).at(state), b = PlacedPoint(model, spring.b).at(state);
    const double length = (b - a).norm();
    if (!(length > 0)) continue;
    const Vec3<double> pull = spring.stiffness * (length - spring.rest_length) / length * (b - a);
    if (m.a.part >= 0) arrows.push_back({a, pull});
    if (m.b.part >= 0) arrows.push_back({b, -pull});
  }
  for (const ForceModel& m : model.forces()) {
    if (m.force->custom) continue;
    Vec3<double> force = m.force->force.value(state.time());
    if (m.force->frame == Frame::body) force = model.orientation(state, m.at.part) * force;
    arrows.push_back({PlacedPoint(model, m.force->at).at(state), force});
  }
  return arrows;
}

}  // namespace pliant
