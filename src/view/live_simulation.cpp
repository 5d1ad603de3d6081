#include <pliant/view/live_simulation.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include <pliant/body/placed_point.h>
#include <pliant/math/time/sum_of_functions.h>

namespace pliant {

namespace {

/// Adds the keys of the next interval, from `now` to `next` (s), to a path, which then ends at `value`. Does
/// nothing if the path already ends at this value.
void extend(LinearKeys& path, double value, double now, double next) {
  const double last = path.values().back();
  if (value == last) return;
  if (path.times().back() < now) path.append(now, last);
  path.append(next, value);
}

/// Returns the diagonal (m) of the box around all parts, where each part is a ball with its size as radius.
double extent(const Simulation& simulation) {
  Eigen::AlignedBox3d all;
  for (std::size_t i = 0; i < simulation.model().parts().size(); ++i) {
    const Vec3<double> c = simulation.model().position(simulation.state(), static_cast<int>(i));
    const Vec3<double> size = Vec3<double>::Constant(simulation.model().parts()[i].size);
    all.extend(c - size).extend(c + size);
  }
  return all.diagonal().norm();
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
    : scene_(&scene), threads_(threads), rate_(display_rate), changing_gravity_(scene.body.changing_gravity) {
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
  find_drive_stiffnesses();
  stable_.emplace(*simulation_, scene.tolerance > 0 ? 0 : scene.step);
  bound_stiffnesses();
  bound_local_stiffnesses();
}

/// Replaces each rest value that the user can change by a function of time.
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
    const Vec3<double> last = drag.path.last(), way = drag.target - last;
    const double length = way.norm();
    drag.path.append(next, length <= drag.reach ? drag.target : last + drag.reach / length * way);
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
  for (DriveStiffness& stiffness : drive_stiffnesses_)
    if (stiffness.path) extend(*stiffness.path, stiffness.next, now, next);
}

void LiveSimulation::rebuild() {
  simulation_ = std::make_unique<Simulation>(scene_->body, scene_->integrator, threads_, scene_->tolerance);
}

void LiveSimulation::reset() {
  simulation_.reset();
  for (const Drag& drag : drags_) scene_->body.remove(*drag.spring);
  drags_.clear();
  scene_->body.changing_gravity = changing_gravity_;
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
  for (DriveStiffness& stiffness : drive_stiffnesses_) {
    stiffness.drive->stiffness = stiffness.next = stiffness.first;
    stiffness.path.reset();
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
  const bool valid = stiffness >= 0 && damping >= 0 && std::isfinite(stiffness + damping);
  const SpringConstants wanted{stiffness, damping},
      bounded = valid ? bound_drag(wanted, exact) : wanted;  // MultiBody::spring() refuses invalid constants
  const Vec3<double> start = PlacedPoint(simulation_->model(), exact).at(state);
  GrowingPath path(now, start);
  Spring& spring =
      scene_->body.spring(new_name(), exact, world(path.function()), bounded.stiffness, bounded.damping);
  spring.on = now;
  const double speed = std::max(kMaxHandSpeed * point.part->size(), extent(*simulation_));
  drags_.push_back({&spring, place, std::move(path), start, speed / rate_});
  wake(state, scene_->body.index(*point.part));
  continue_from(std::move(state));
}

/// Returns constants of a drag with which the fixed steps are stable and resolve the motion of the part. As
/// long as stability would reduce the constants, doubles the patch of nodes at the point, and with it the
/// dragged mass, but not beyond kLargestPatch sizes of the part.
SpringConstants LiveSimulation::bound_drag(const SpringConstants& constants, Point& at) const {
  constexpr double kLargestPatch = 0.5;
  const SpringConstants wanted = stable_->resolved(constants, inverse_mass(*simulation_, at));
  for (;;) {
    const SpringConstants bounded =
        stable_->bounded(simulation_->integrator(), wanted, inverse_mass(*simulation_, at).total());
    const bool whole = bounded.stiffness == wanted.stiffness && bounded.damping == wanted.damping;
    if (whole || at.patch == 0 || 2 * at.patch > kLargestPatch * at.part->size()) return bounded;
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

/// Makes the simulation of the changed body and continues from a state of the old simulation.
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
    const Vec3<double> first = changing_gravity_ ? Vec3<double>::Zero() : scene_->body.gravity;
    gravity_ = std::make_unique<GrowingPath>(0, first);
    TimeVector all = gravity_->function();
    if (changing_gravity_)
      for (std::size_t i = 0; i < 3; ++i)
        all.component[i] = changing_gravity_->component[i] + all.component[i];
    scene_->body.changing_gravity = all;
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
