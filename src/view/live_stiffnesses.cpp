// The functions of LiveSimulation that change stiffnesses: of springs, parameters, their drives and local
// deformations.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <pliant/body/placed_point.h>
#include <pliant/simulate/stable_step.h>
#include <pliant/view/live_simulation.h>

namespace pliant {

void LiveSimulation::find_stiffnesses() {
  const auto& springs = scene_->body.springs();
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const StateFunction& stiffness = springs[i]->stiffness;
    if (!stiffness.is_constant() || !(stiffness.constant() > 0)) continue;
    const double first = stiffness.constant();
    stiffnesses_.push_back({springs[i].get(), i, first, first, nullptr, first});
  }
}

void LiveSimulation::set_stiffness(std::size_t i, double value) {
  SpringStiffness& stiffness = stiffnesses_.at(i);
  Spring& spring = *stiffness.spring;
  if (!(value >= 0) || !std::isfinite(value))
    throw std::invalid_argument("a stiffness of " + std::to_string(value) + " N/m for the spring " +
                                spring.name + "; expected a number of at least 0");
  stiffness.next = value;
  if (stiffness.path) return;
  State state = simulation_->state();
  const double now = time_after(intervals_);
  const auto place = [&](const Point& end) -> Vec3<double> {
    return end.part == nullptr ? end.world.value(now) : PlacedPoint(simulation_->model(), end).at(state);
  };
  if (spring.acts_at(now))
    state.work[static_cast<int>(Work::actuation)] -= spring.energy(place(spring.a), place(spring.b));
  stiffness.path = std::make_shared<LinearKeys>(std::vector<double>{0}, std::vector<double>{stiffness.first});
  spring.stiffness = TimeFunction(stiffness.path);
  continue_from(std::move(state));
}

void LiveSimulation::find_parameter_stiffnesses() {
  for (std::size_t i = 0; i < rest_values_.size(); ++i) {
    const Part& part = *rest_values_[i].part;
    const int k = part.parameters().dynamic_number(rest_values_[i].parameter);
    const auto is_driven = [&](const auto& drive) { return drive->on.part == &part && drive->on.index == k; };
    const auto& drives = scene_->body.drives();
    if (part.local() != nullptr && simulation_->integrator().local_is_implicit()) continue;
    const double stiffness = part.K_s()(k, k);
    if (!(stiffness > 0) || std::any_of(drives.begin(), drives.end(), is_driven)) continue;
    const bool alone = (part.K_s().row(k).array() != 0).count() == 1;
    parameter_stiffnesses_.push_back(
        {i, stiffness, alone ? 0 : stiffness, stiffness, nullptr, nullptr, stiffness});
  }
}

void LiveSimulation::find_drive_stiffnesses() {
  for (const auto& drive : scene_->body.drives()) {
    const Part* part = drive->on.part;
    if (drive->on.kind != Signal::Kind::parameter || part->fixed()) continue;
    if (!drive->stiffness.is_constant() || !(drive->stiffness.constant() > 0)) continue;
    if (part->local() != nullptr && simulation_->integrator().local_is_implicit()) continue;
    const double first = drive->stiffness.constant();
    drive_stiffnesses_.push_back(
        {drive.get(), part, part->parameters().moving(drive->on.index).name, first, first, nullptr, first});
  }
}

/// Finds the largest stiffnesses of springs, drives and parameters with which the fixed steps are stable.
void LiveSimulation::bound_stiffnesses() {
  constexpr double most_of_springs = 10, most_of_drives = 10, most_of_parameters = 100;
  const Integrator& method = simulation_->integrator();
  const auto bounded = [&](double first, double most, double inverse_mass) {
    return first + stable_->bounded(method, {(most - 1) * first, 0}, inverse_mass).stiffness;
  };
  for (SpringStiffness& stiffness : stiffnesses_) {
    double inverse_masses = 0;
    for (const Point* end : {&stiffness.spring->a, &stiffness.spring->b})
      if (end->part != nullptr && !end->part->fixed())
        inverse_masses += inverse_mass(*simulation_, *end).total();
    stiffness.most = bounded(stiffness.first, most_of_springs, inverse_masses);
  }
  for (ParameterStiffness& stiffness : parameter_stiffnesses_) {
    const RestValue& rest = rest_values_[stiffness.rest];
    const int k = rest.part->parameters().dynamic_number(rest.parameter);
    stiffness.most = bounded(stiffness.first, most_of_parameters, inverse_mass(*simulation_, *rest.part, k));
  }
  for (DriveStiffness& stiffness : drive_stiffnesses_)
    stiffness.most = bounded(stiffness.first, most_of_drives,
                             inverse_mass(*simulation_, *stiffness.part, stiffness.drive->on.index));
}

void LiveSimulation::set_parameter_stiffness(std::size_t i, double value) {
  ParameterStiffness& stiffness = parameter_stiffnesses_.at(i);
  const RestValue& rest = rest_values_[stiffness.rest];
  const std::string name = rest.part->name() + "." + rest.parameter;
  if (!(value >= stiffness.least) || !std::isfinite(value)) {
    std::ostringstream message;
    message << "a stiffness of " << value << " for " << name << "; expected a number of at least "
            << stiffness.least;
    throw std::invalid_argument(message.str());
  }
  stiffness.next = value;
  if (stiffness.servo != nullptr || value == stiffness.first) return;
  stiffness.added = std::make_shared<LinearKeys>(std::vector<double>{0}, std::vector<double>{0});
  stiffness.servo = &scene_->body.drive(name, *rest.part, rest.parameter);
  stiffness.servo->target = TimeFunction(rest.path);
  stiffness.servo->stiffness = TimeFunction(stiffness.added);
  continue_from(simulation_->state());
}

void LiveSimulation::set_drive_stiffness(std::size_t i, double value) {
  DriveStiffness& stiffness = drive_stiffnesses_.at(i);
  Drive& drive = *stiffness.drive;
  if (!(value >= 0) || !std::isfinite(value))
    throw std::invalid_argument("a stiffness of " + std::to_string(value) + " for the drive of " +
                                stiffness.part->name() + "." + stiffness.parameter +
                                "; expected a number of at least 0");
  stiffness.next = value;
  if (stiffness.path) return;
  State state = simulation_->state();
  if (drive.is_passive()) {
    const Part& part = *stiffness.part;
    const int number = part.parameters().find(stiffness.parameter);
    const auto values = simulation_->model().values(state, scene_->body.index(part));
    const double difference = drive.target.constant() - values.b[static_cast<std::size_t>(number)];
    state.work[static_cast<int>(Work::actuation)] -= 0.5 * stiffness.first * difference * difference;
  }
  stiffness.path = std::make_shared<LinearKeys>(std::vector<double>{0}, std::vector<double>{stiffness.first});
  drive.stiffness = TimeFunction(stiffness.path);
  continue_from(std::move(state));
}

/// Replaces each factor of local stiffness that the user can change by a function of time.
void LiveSimulation::free_local_stiffnesses() {
  for (const auto& part : scene_->body.parts()) {
    if (part->fixed()) continue;
    part->prepare();
    if (part->local() == nullptr || part->local_factor() != nullptr) continue;
    auto path = std::make_shared<LinearKeys>(std::vector<double>{0}, std::vector<double>{1});
    part->scale_local(TimeFunction(path));
    local_stiffnesses_.push_back({part.get(), 1, std::move(path), 1});
  }
}

/// Returns whether the steps of the scene are stable at time 0 with this factor, or as stable as without it.
/// stable_without: the largest stable step without the factor, s.
bool LiveSimulation::is_stable(const LocalStiffness& stiffness, double factor, double stable_without) {
  stiffness.path->restart(0, factor);
  const bool stable = stable_step(*simulation_).step >= std::min(scene_->step, stable_without);
  stiffness.path->restart(0, 1);
  return stable;
}

/// Finds the largest factors with which the fixed steps are stable: the squared frequencies grow with the
/// factor. Leaves out the parts for which a smaller factor makes the steps unstable: their modes are faster
/// than the steps.
void LiveSimulation::bound_local_stiffnesses() {
  constexpr double most = 100, share = 0.8;
  if (local_stiffnesses_.empty()) return;
  if (scene_->tolerance > 0 || simulation_->integrator().local_is_implicit()) {
    for (LocalStiffness& stiffness : local_stiffnesses_) stiffness.most = most;
    return;
  }
  const double stable_without = stable_step(*simulation_).step, ratio = stable_without / scene_->step;
  std::vector<LocalStiffness> stable;
  for (LocalStiffness& stiffness : local_stiffnesses_) {
    if (stiffness.part->local()->modal() != nullptr && !is_stable(stiffness, 0.5, stable_without)) continue;
    double factor = std::min(most, share * ratio * ratio);
    while (factor > 1 && !is_stable(stiffness, factor, stable_without)) factor *= share;
    stiffness.most = std::max(1.0, factor);
    stable.push_back(stiffness);
  }
  local_stiffnesses_ = std::move(stable);
}

void LiveSimulation::set_local_stiffness(std::size_t i, double factor) {
  LocalStiffness& stiffness = local_stiffnesses_.at(i);
  if (!(factor >= 0) || !std::isfinite(factor))
    throw std::invalid_argument("a factor of " + std::to_string(factor) + " for the local stiffness of " +
                                stiffness.part->name() + "; expected a number of at least 0");
  stiffness.next = factor;
}

}  // namespace pliant
