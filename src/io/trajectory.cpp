#include <pliant/io/trajectory.h>

#include <utility>

#include <pliant/io/format/csv_cell.h>
#include <pliant/io/format/number_text.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/state_row.h>

namespace pliant {
namespace {

constexpr const char* kAxes[3] = {".x", ".y", ".z"};

void add_axes(std::vector<Column>& columns, const std::string& stem, const char* unit, const char* meaning) {
  for (const char* axis : kAxes) columns.push_back({stem + axis, unit, meaning});
}

void add_some(std::vector<Column>& columns, const std::vector<Column>& more, int n) {
  columns.insert(columns.end(), more.begin(), more.begin() + n);
}

void add_vector(std::vector<double>& numbers, const Vec3<double>& x) {
  numbers.insert(numbers.end(), {x[0], x[1], x[2]});
}

// Returns whether a joint transmits a torque: a joint with several points per side constrains rotation.
bool has_torque(const JointModel& joint) {
  return joint.joint->n_first() > 1;
}

}  // namespace

TrajectoryTable::TrajectoryTable(const Scene& scene, Simulation& simulation)
    : scene_(&scene),
      simulation_(&simulation),
      parts_shown_(scene.every_part.value_or(simulation.model().parts().size() <= kMaxParts)) {
  // The centre of mass of a deforming part moves away from the origin of its frame, unless the shape stays
  // symmetric. The state at time 0 does not show which parts stay symmetric, so every part with deformations
  // and dynamic parameters gets the columns.
  for (const PartModel& part : simulation.model().parts()) {
    const double offset = part.part->rest_inertia().moment.norm();
    const bool moved = offset > 1e-12 * part.part->total_mass() * part.size;
    centre_shown_.push_back(part.q0 >= 0 &&
                            (moved || (part.n_s > 0 && !part.part->parameters().links().empty())));
    local_shown_ = local_shown_ || part.local != nullptr;
  }
  for (const Track& track : scene.tracks) tracked_.emplace_back(simulation.model(), track.point);
}

/// Returns the columns of a part, with "*" for its name.
std::vector<Column> TrajectoryTable::part_columns(std::size_t i) const {
  const Model& model = simulation_->model();
  const PartModel& part = model.parts()[i];
  if (part.q0 < 0) return {};
  std::vector<Column> columns;
  // The coordinates of local deformation have columns in q.npy and v.npy only.
  add_some(columns, coordinate_columns(model, part), 7 + part.n_s);
  add_some(columns, velocity_columns(model, part), 6 + part.n_s);
  if (centre_shown_[i]) add_axes(columns, "*.com", "m", "centre of mass, world");
  return columns;
}

/// Returns the columns of a joint, with "*" for its name.
std::vector<Column> TrajectoryTable::joint_columns(std::size_t j) const {
  std::vector<Column> columns;
  add_axes(columns, "joint.*.force", "N", "force on the first side of the joint, world");
  if (has_torque(simulation_->model().joints()[j]))
    add_axes(columns, "joint.*.torque", "N m",
             "torque on the first side of the joint, about the joint, world");
  columns.push_back({"joint.*.gap", "m", "distance by which the joint is open"});
  return columns;
}

/// Returns the columns of energies, works and momenta.
std::vector<Column> TrajectoryTable::total_columns() const {
  std::vector<Column> columns;
  for (const char* energy : {"kinetic", "gravity", "elastic", "springs"})
    columns.push_back({std::string("energy.") + energy, "J", ""});
  if (local_shown_) columns.push_back({"energy.local", "J", "elastic energy of local deformation"});
  columns.push_back({"energy.total", "J", "sum of the energies"});
  for (const char* work : kWorkNames) columns.push_back({std::string("work.") + work, "J", "work so far"});
  columns.push_back(
      {"balance", "J",
       "energy.total - its value at time 0 - all works: the energy error of the method, to be compared with "
       "the change of the energies"});
  add_axes(columns, "momentum", "kg m/s", "momentum of all moving parts, world");
  add_axes(columns, "angular_momentum", "kg m^2/s",
           "angular momentum of all moving parts about the world's origin");
  return columns;
}

TableColumns TrajectoryTable::columns() const {
  TableColumns table{table_group({{"t", "s", "time"}})};
  if (parts_shown_)
    table.push_back(
        {ColumnGroup::Each::part, "trajectory", [this](std::size_t i) { return part_columns(i); }});
  std::vector<Column> tracked;
  for (const Track& track : scene_->tracks)
    add_axes(tracked, "track." + track.name, "m", "tracked point, world");
  table.push_back(table_group(std::move(tracked)));
  std::vector<Column> sensors;
  for (const auto& sensor : scene_->body.sensors())
    sensors.push_back({"sensor." + sensor->name, "", "value of the sensor"});
  table.push_back(table_group(std::move(sensors)));
  if (parts_shown_)
    table.push_back(
        {ColumnGroup::Each::joint, "trajectory", [this](std::size_t j) { return joint_columns(j); }});
  table.push_back(table_group(total_columns()));
  return table;
}

void TrajectoryTable::add_part(const State& state, std::size_t i, const Workspace<double>& work,
                               std::vector<double>& numbers) const {
  const PartModel& part = simulation_->model().parts()[i];
  if (part.q0 < 0) return;
  const double *q = state.q.data() + part.q0, *v = state.v.data() + part.v0;
  numbers.insert(numbers.end(), q, q + 7 + part.n_s);
  numbers.insert(numbers.end(), v, v + 6 + part.n_s);
  if (!centre_shown_[i]) return;
  const PartWorkspace<double>& now = work.parts[i];
  add_vector(numbers, now.c + now.R * now.inertia.moment / now.inertia.mass);
}

void TrajectoryTable::row(const State& state, std::vector<double>& numbers) {
  simulation_->evaluate_output([&](Workspace<double>& work) { evaluate_row(state, work, numbers); });
}

void TrajectoryTable::evaluate_row(const State& state, Workspace<double>& work,
                                   std::vector<double>& numbers) const {
  const Model& model = simulation_->model();
  Ledger ledger = simulation_->dynamics().ledger(state, work);
  ledger.balance = ledger.energy() - simulation_->start_energy() - ledger.work.sum();
  numbers.assign(1, state.time());
  for (std::size_t i = 0; parts_shown_ && i < model.parts().size(); ++i) add_part(state, i, work, numbers);
  for (const PlacedPoint& point : tracked_) add_vector(numbers, point.at(state));
  const VecX<double> sensors = simulation_->dynamics().sensor_values(state.time(), state, work);
  numbers.insert(numbers.end(), sensors.data(), sensors.data() + sensors.size());
  for (int j = 0; parts_shown_ && j < static_cast<int>(model.joints().size()); ++j) {
    const Wrench wrench = simulation_->dynamics().joint_wrench(state.time(), j, work);
    add_vector(numbers, wrench.force);
    if (has_torque(model.joints()[static_cast<std::size_t>(j)])) add_vector(numbers, wrench.torque);
    numbers.push_back(model.gap(state, j));
  }
  numbers.insert(numbers.end(), {ledger.kinetic, ledger.gravity, ledger.elastic, ledger.springs});
  if (local_shown_) numbers.push_back(ledger.local);
  numbers.push_back(ledger.energy());
  numbers.insert(numbers.end(), ledger.work.data(), ledger.work.data() + kWorks);
  numbers.push_back(ledger.balance);
  add_vector(numbers, ledger.momentum);
  add_vector(numbers, ledger.angular_momentum);
}

void write_trajectory(const std::filesystem::path& path, const Scene& scene, Simulation& simulation,
                      const Recording& recording) {
  TrajectoryTable table(scene, simulation);
  WholeFile file(path);
  std::string text;
  for (const Column& column : all_columns(table.columns(), simulation.model()))
    text += (text.empty() ? "" : ",") + csv_cell(column.name);
  text += '\n';
  std::vector<double> numbers;
  for (std::int64_t i = 0; i < recording.rows(); ++i) {
    table.row(recording.state(i), numbers);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      if (k > 0) text += ',';
      append_number(text, numbers[k]);
    }
    text += '\n';
    if (text.size() > 1 << 20) {
      file.write(text);
      text.clear();
    }
  }
  file.write(text);
  file.become_target();
}

}  // namespace pliant
