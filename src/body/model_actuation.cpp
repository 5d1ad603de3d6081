// The set-up of a model: coordinates, sensors, drives, and the functions of loads that read the state.
#include <algorithm>
#include <stdexcept>

#include <pliant/body/model.h>

namespace pliant {

namespace {

int place_of(const std::vector<CoordinateModel>& coordinates, const Joint* coordinate) {
  const auto same = [&](const CoordinateModel& m) { return m.coordinate == coordinate; };
  const auto found = std::find_if(coordinates.begin(), coordinates.end(), same);
  return found == coordinates.end() ? -1 : static_cast<int>(found - coordinates.begin());
}

}  // namespace

template <class Act>
void Model::for_each_load(Act&& act) const {
  auto call = [&](std::vector<int> parts) {
    parts.erase(std::remove_if(parts.begin(), parts.end(), [](int i) { return i < 0; }), parts.end());
    std::sort(parts.begin(), parts.end());
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    act(parts);
  };
  auto with = [&](std::vector<int> parts, const std::vector<FunctionModel>& functions) {
    for (const FunctionModel& function : functions) append_parts(function, parts);
    call(std::move(parts));
  };
  for (const SpringModel& spring : springs_) with({spring.a.part, spring.b.part}, spring.functions);
  for (const ForceModel& force : forces_) with({force.at.part}, force.components);
  for (const TorqueModel& torque : torques_) with({torque.part, torque.against}, torque.components);
  for (const DistributedModel& m : distributed_forces_)
    with({m.part}, {m.density[0], m.density[1], m.density[2], m.pressure});
  for (const DriveModel& drive : drives_) {
    std::vector<int> parts;
    append_parts(drive.on, parts);
    with(std::move(parts), {drive.target, drive.target_rate, drive.stiffness, drive.damping, drive.force});
  }
}

void Model::add_actuation() {
  add_coordinates();
  add_sensors();
  for (SpringModel& m : springs_)
    if (const Spring& s = *m.spring; !s.is_constant())
      for (const StateFunction* function : {&s.stiffness, &s.damping, &s.rest_length})
        m.functions.push_back(resolve(*function, "spring '" + s.name + "'"));
  for (ForceModel& m : forces_)
    if (m.force->force.reads_state())
      for (const StateFunction& component : m.force->force.component)
        m.components.push_back(resolve(component, "force '" + m.force->name + "'"));
  for (TorqueModel& m : torques_)
    if (m.torque->torque.reads_state())
      for (const StateFunction& component : m.torque->torque.component)
        m.components.push_back(resolve(component, "torque '" + m.torque->name + "'"));
  resolve_distributed_forces();
  add_drives();
}

void Model::add_coordinates() {
  for (const auto& coordinate : body_->coordinates()) {
    const std::vector<Point>& points = coordinate->points();
    if (!is_whole() &&
        std::none_of(points.begin(), points.end(), [&](const Point& p) { return moves(p.part); }))
      continue;
    // A hinge and a slider have the points of their coordinate, so the coordinate needs no other ports.
    const auto joint = std::find_if(joints_.begin(), joints_.end(), [&](const JointModel& m) {
      return m.joint->name() == coordinate->name() && m.at.size() == points.size();
    });
    CoordinateModel m{coordinate.get(), {}};
    if (joint != joints_.end()) m.at = joint->at;
    for (std::size_t k = 0; joint == joints_.end() && k < points.size(); ++k)
      m.at.push_back(attach(points[k], "coordinate of joint '" + coordinate->name() + "'"));
    coordinates_.push_back(std::move(m));
  }
}

void Model::add_sensors() {
  for (std::size_t k = 0; k < body_->sensors().size(); ++k) {
    const Sensor& sensor = *body_->sensors()[k];
    const auto& signals = sensor.value.signals();
    const bool present = std::all_of(signals.begin(), signals.end(), [&](const Signal& s) {
      auto has = [&](const Part* part) { return part == nullptr || number_of(*part) >= 0; };
      const bool coordinate = s.coordinate == nullptr || place_of(coordinates_, s.coordinate) >= 0;
      const bool read = s.sensor == nullptr ||
                        std::any_of(sensors_.begin(), sensors_.end(), [&](const FunctionModel& earlier) {
                          return earlier.function == &s.sensor->value;
                        });
      return has(s.part) && has(s.a.part) && has(s.b.part) && coordinate && read;
    });
    if (!present && is_whole())
      throw std::invalid_argument("sensor '" + sensor.name + "' reads a sensor that was not added before it");
    if (!present) continue;
    sensors_.push_back(resolve(sensor.value, "sensor '" + sensor.name + "'"));
    sensor_numbers_.push_back(static_cast<int>(k));
  }
}

void Model::add_drives() {
  for (const auto& drive : body_->drives()) {
    const Signal& on = drive->on;
    if (on.coordinate != nullptr ? place_of(coordinates_, on.coordinate) < 0 : !moves(on.part)) continue;
    const std::string what = "drive '" + drive->name + "'";
    DriveModel m{drive.get(), resolve(on, what), resolve(drive->target, what), {}, {}, {}, {}};
    if (drive->target_rate) m.target_rate = resolve(*drive->target_rate, what);
    m.stiffness = resolve(drive->stiffness, what);
    m.damping = resolve(drive->damping, what);
    m.force = resolve(drive->force, what);
    drives_.push_back(std::move(m));
  }
}

FunctionModel Model::resolve(const StateFunction& function, const std::string& what) {
  FunctionModel m{&function, {}};
  for (const Signal& signal : function.signals()) m.signals.push_back(resolve(signal, what));
  return m;
}

SignalModel Model::resolve(const Signal& signal, const std::string& what) {
  using Kind = Signal::Kind;
  SignalModel m{&signal, -1, {}, {}, -1};
  switch (signal.kind) {
    case Kind::point:
    case Kind::point_rate:
      m.a = attach(signal.a, what);
      break;
    case Kind::distance:
    case Kind::distance_rate:
      m.a = attach(signal.a, what);
      m.b = attach(signal.b, what);
      break;
    case Kind::coordinate:
    case Kind::coordinate_rate:
      m.place = place_of(coordinates_, signal.coordinate);
      break;
    case Kind::input:
    case Kind::at_point:
      break;
    case Kind::sensor: {
      const auto same = [&](const FunctionModel& s) { return s.function == &signal.sensor->value; };
      m.place = static_cast<int>(std::find_if(sensors_.begin(), sensors_.end(), same) - sensors_.begin());
      break;
    }
    default:
      m.part = number_of(*signal.part);
  }
  return m;
}

void Model::append_parts(const FunctionModel& function, std::vector<int>& parts) const {
  for (const SignalModel& signal : function.signals) append_parts(signal, parts);
}

void Model::append_parts(const SignalModel& signal, std::vector<int>& parts) const {
  parts.insert(parts.end(), {signal.part, signal.a.part, signal.b.part});
  if (signal.place < 0) return;
  if (signal.signal->kind == Signal::Kind::sensor)
    return append_parts(sensors_[static_cast<std::size_t>(signal.place)], parts);
  for (const PortRef& ref : coordinates_[static_cast<std::size_t>(signal.place)].at)
    parts.push_back(ref.part);
}

void Model::mark_loaded_parts() {
  for_each_load([&](const std::vector<int>& parts) {
    for (const int i : parts) parts_[static_cast<std::size_t>(i)].loaded = true;
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = a + 1; b < parts.size(); ++b) load_connections_.emplace_back(parts[a], parts[b]);
  });
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i].loaded) {
      loaded_parts_.push_back(static_cast<int>(i));
      if (parts_[i].island >= 0) islands_[static_cast<std::size_t>(parts_[i].island)].loaded = true;
    }
}

}  // namespace pliant
