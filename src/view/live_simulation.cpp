#include <pliant/view/live_simulation.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <pliant/body/placed_point.h>
#include <pliant/simulate/stable_step.h>

namespace pliant {

namespace {

/// Adds the keys of the next interval, from `now` to `next` (s), to a path that goes to a value. Does nothing
/// if the path has this value already.
void extend(LinearKeys& path, double value, double now, double next) {
  const double last = path.values().back();
  if (value == last) return;
  if (path.times().back() < now) path.append(now, last);
  path.append(next, value);
}

}  // namespace

GrowingPath::GrowingPath(double t, const Vec3<double>& x) {
  for (int i = 0; i < 3; ++i)
    component[i] = std::make_shared<LinearKeys>(std::vector<double>{t}, std::vector<double>{x[i]});
}

void GrowingPath::append(double t, const Vec3<double>& x) {
  for (int i = 0; i < 3; ++i) component[i]->append(t, x[i]);
}

Vec3<double> GrowingPath::last() const {
  return {component[0]->values().back(), component[1]->values().back(), component[2]->values().back()};
}

TimeVector GrowingPath::function() const {
  return {TimeFunction(component[0]), TimeFunction(component[1]), TimeFunction(component[2])};
}

LiveSimulation::LiveSimulation(Scene& scene, double display_rate, int threads)
    : scene_(&scene), threads_(threads), rate_(display_rate) {
  if (!(display_rate > 0) || !std::isfinite(display_rate))
    throw std::invalid_argument("a display rate of " + std::to_string(display_rate) +
                                " per second; expected a positive number");
  if (scene.tolerance == 0) {
    steps_ = std::max<std::int64_t>(1, std::llround(1 / (display_rate * scene.step)));
    rate_ = 1 / (static_cast<double>(steps_) * scene.step);
  }
  scene.body.stop_rate = rate_;
  free_rest_values();
  free_local_stiffnesses();
  find_stiffnesses();
  if (scene.integrator == kAutomatic)
    scene.integrator = Simulation(scene.body, kAutomatic, threads, scene.tolerance).integrator().name();
  reset();
  find_parameter_stiffnesses();
  stable_.emplace(*simulation_, scene.tolerance > 0 ? 0 : scene.step);
  bound_stiffnesses();
  bound_local_stiffnesses();
}

/// Makes the rest values that the user can change functions of time.
void LiveSimulation::free_rest_values() {
  for (const auto& part : scene_->body.parts()) {
    if (part->fixed() || part->continuum() != nullptr) continue;
    part->prepare();
    const Parameters& parameters = part->parameters();
    std::vector<RestValue> found;
    for (int k = 0; k < parameters.n_dynamic(); ++k) {
      const Parameter& parameter = parameters.moving(k);
      if (!parameter.rest.is_constant() || part->K_s().row(k).isZero(0)) continue;
      const double value = parameter.rest_value();
      found.push_back({part.get(), parameter.name, parameter.spec->frozen, value,
                       std::make_shared<LinearKeys>(std::vector<double>{0}, std::vector<double>{value}),
                       value});
    }
    for (const RestValue& rest : found) part->rest(rest.parameter, TimeFunction(rest.path));
    rest_values_.insert(rest_values_.end(), found.begin(), found.end());
  }
}

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

/// Finds up to which stiffnesses of springs and parameters the fixed steps are stable.
void LiveSimulation::bound_stiffnesses() {
  constexpr double most_of_springs = 10, most_of_parameters = 100;
  const Integrator& method = simulation_->integrator();
  const auto bounded = [&](double first, double most, double inverse_mass) {
    return first + stable_->bounded(method, {(most - 1) * first, 0}, inverse_mass).stiffness;
  };
  for (SpringStiffness& stiffness : stiffnesses_) {
    double inverse_masses = 0;
    for (const Point* end : {&stiffness.spring->a, &stiffness.spring->b})
      if (end->part != nullptr && !end->part->fixed()) inverse_masses += inverse_mass(*simulation_, *end);
    stiffness.most = bounded(stiffness.first, most_of_springs, inverse_masses);
  }
  for (ParameterStiffness& stiffness : parameter_stiffnesses_) {
    const RestValue& rest = rest_values_[stiffness.rest];
    const int k = rest.part->parameters().dynamic_number(rest.parameter);
    stiffness.most = bounded(stiffness.first, most_of_parameters, inverse_mass(*simulation_, *rest.part, k));
  }
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

/// Makes the factors of local stiffness that the user can change functions of time.
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

/// Returns whether the steps of the scene are stable at time 0 with this factor.
bool LiveSimulation::is_stable(const LocalStiffness& stiffness, double factor) {
  stiffness.path->restart(0, factor);
  const bool stable = stable_step(*simulation_).step >= scene_->step;
  stiffness.path->restart(0, 1);
  return stable;
}

/// Finds up to which factors the fixed steps are stable: the squared frequencies grow with the factor. Leaves
/// out the parts for which a smaller factor makes the steps unstable: their modes are faster than the steps.
void LiveSimulation::bound_local_stiffnesses() {
  constexpr double most = 100, share = 0.8;
  if (local_stiffnesses_.empty()) return;
  if (scene_->tolerance > 0 || simulation_->integrator().local_is_implicit()) {
    for (LocalStiffness& stiffness : local_stiffnesses_) stiffness.most = most;
    return;
  }
  const double ratio = stable_step(*simulation_).step / scene_->step;
  std::vector<LocalStiffness> stable;
  for (LocalStiffness& stiffness : local_stiffnesses_) {
    if (stiffness.part->local()->modal() != nullptr && !is_stable(stiffness, 0.5)) continue;
    double factor = std::min(most, ratio * ratio);
    while (factor > 1 && !is_stable(stiffness, factor)) factor *= share;
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

void LiveSimulation::set_rest_value(std::size_t i, double value) {
  RestValue& rest = rest_values_.at(i);
  if (!rest.range.contains(value))
    throw std::invalid_argument("the rest value " + std::to_string(value) + " of " + rest.part->name() + "." +
                                rest.parameter + " is out of range");
  rest.next = value;
}

/// Adds the keys of the next interval, from `now` to `next` (s), to the paths that change.
void LiveSimulation::extend_paths(double now, double next) {
  for (Drag& drag : drags_) {
    if (std::isfinite(drag.spring->off)) continue;
    drag.path.append(next, drag.target);
    if (drag.ends) drag.spring->off = next;
  }
  if (gravity_ && next_gravity_ != gravity_->last()) {
    if (gravity_->last_time() < now) gravity_->append(now, gravity_->last());
    gravity_->append(next, next_gravity_);
  }
  for (RestValue& rest : rest_values_) extend(*rest.path, rest.next, now, next);
  for (LocalStiffness& stiffness : local_stiffnesses_) extend(*stiffness.path, stiffness.next, now, next);
  for (SpringStiffness& stiffness : stiffnesses_)
    if (stiffness.path) extend(*stiffness.path, stiffness.next, now, next);
  for (ParameterStiffness& stiffness : parameter_stiffnesses_)
    if (stiffness.servo != nullptr) extend(*stiffness.added, stiffness.next - stiffness.first, now, next);
}

void LiveSimulation::rebuild() {
  simulation_ = std::make_unique<Simulation>(scene_->body, scene_->integrator, threads_, scene_->tolerance);
}

void LiveSimulation::reset() {
  simulation_.reset();
  for (const Drag& drag : drags_) scene_->body.remove(*drag.spring);
  drags_.clear();
  if (gravity_) scene_->body.changing_gravity.reset();
  gravity_.reset();
  for (RestValue& rest : rest_values_) rest.path->restart(0, rest.next = rest.first);
  for (LocalStiffness& stiffness : local_stiffnesses_) stiffness.path->restart(0, stiffness.next = 1);
  for (SpringStiffness& stiffness : stiffnesses_) {
    stiffness.spring->stiffness = stiffness.next = stiffness.first;
    stiffness.path.reset();
  }
  for (ParameterStiffness& stiffness : parameter_stiffnesses_) {
    stiffness.next = stiffness.first;
    if (stiffness.servo != nullptr) scene_->body.remove(*stiffness.servo);
    stiffness.servo = nullptr;
  }
  intervals_ = 0;
  rebuild();
}

void LiveSimulation::advance() {
  const double next = time_after(intervals_ + 1);
  extend_paths(time_after(intervals_), next);
  if (steps_ > 0)
    for (std::int64_t i = 0; i < steps_; ++i) simulation_->step(scene_->step);
  else
    while (simulation_->time() < next) simulation_->step_up_to(next);
  ++intervals_;
}

void LiveSimulation::grab(const Point& point, double stiffness, double damping) {
  if (point.part == nullptr || point.part->fixed())
    throw std::invalid_argument("only points of moving parts can be dragged");
  const double now = time_after(intervals_);
  State state = simulation_->state();
  const MaterialAngles place = angles(point.material);
  Point exact = point;
  exact.material = material_at(place.u, place.v, place.w);
  const SpringConstants bounded = bound_drag({stiffness, damping}, exact);
  const Vec3<double> start = PlacedPoint(simulation_->model(), exact).at(state);
  GrowingPath path(now, start);
  Spring& spring =
      scene_->body.spring(new_name(), exact, world(path.function()), bounded.stiffness, bounded.damping);
  spring.on = now;
  drags_.push_back({&spring, place, std::move(path), start});
  wake(state, scene_->body.index(*point.part));
  continue_from(std::move(state));
}

/// Returns constants of a drag with which the fixed steps are stable. Enlarges the patch of nodes at the
/// point, and with it the dragged mass, until they are the wanted ones or the patch is kLargestPatch sizes of
/// the part large.
SpringConstants LiveSimulation::bound_drag(const SpringConstants& wanted, Point& at) const {
  constexpr double kLargestPatch = 0.4;
  for (;;) {
    const SpringConstants bounded =
        stable_->bounded(simulation_->integrator(), wanted, inverse_mass(*simulation_, at));
    const bool whole = bounded.stiffness == wanted.stiffness && bounded.damping == wanted.damping;
    if (whole || at.patch == 0 || at.patch >= kLargestPatch * at.part->size()) return bounded;
    at.patch *= 2;
  }
}

/// Returns a name that no spring has.
std::string LiveSimulation::new_name() const {
  const auto& springs = scene_->body.springs();
  for (std::size_t number = drags_.size() + 1;; ++number) {
    std::string name = "drag " + std::to_string(number);
    if (std::none_of(springs.begin(), springs.end(),
                     [&](const auto& spring) { return spring->name == name; }))
      return name;
  }
}

/// Makes the simulation of the changed body and continues from a state of the old one.
void LiveSimulation::continue_from(State state) {
  const double start_energy = simulation_->start_energy();
  rebuild();
  simulation_->set_state(std::move(state));
  simulation_->set_start_energy(start_energy);
}

bool LiveSimulation::is_dragging() const {
  return !drags_.empty() && !std::isfinite(drags_.back().spring->off);
}

void LiveSimulation::drag_to(const Vec3<double>& position) {
  if (is_dragging()) drags_.back().target = position;
}

void LiveSimulation::release() {
  if (is_dragging()) drags_.back().ends = true;
}

void LiveSimulation::set_gravity(const Vec3<double>& gravity) {
  if (!gravity_) {
    if (scene_->body.changing_gravity)
      throw std::invalid_argument("the gravity of this scene changes in time; it cannot be changed by hand");
    gravity_ = std::make_unique<GrowingPath>(0, scene_->body.gravity);
    scene_->body.changing_gravity = gravity_->function();
    continue_from(simulation_->state());
  }
  next_gravity_ = gravity;
}

SpringConstants drag_spring(const Part& part) {
  constexpr double frequency = 2, damping_ratio = 0.5;
  const double rate = 2 * kPi * frequency, mass = part.total_mass();
  return {mass * rate * rate, 2 * damping_ratio * mass * rate};
}

}  // namespace pliant
