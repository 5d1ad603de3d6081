#include <pliant/io/state_row.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace pliant {
namespace {

/// The hash of a state, cut to 53 bits, which a double holds exactly.
double check_of(const State& state) {
  return static_cast<double>(hash(state) >> 11);
}

const ParameterSpec& dynamic_parameter(const PartModel& part, int k) {
  return *part.part->parameters().moving(k).spec;
}

}  // namespace

std::vector<Column> coordinate_columns(const Model& model, const PartModel& part) {
  std::vector<Column> columns;
  for (int k = 0; k < part.n_q(); ++k) {
    Column column{model.coordinate_name(part.q0 + k), "", ""};
    if (k < 3)
      column.unit = "m", column.meaning = "position of the frame, world";
    else if (k < 7)
      column.unit = "1", column.meaning = "orientation, body to world";
    else if (k >= 7 + part.n_s)
      column.unit = part.local->unit(k - 7 - part.n_s), column.meaning = "local deformation, body frame";
    else
      column.unit = dynamic_parameter(part, k - 7).unit(),
      column.meaning = dynamic_parameter(part, k - 7).meaning;
    columns.push_back(std::move(column));
  }
  return columns;
}

std::vector<Column> velocity_columns(const Model& model, const PartModel& part) {
  std::vector<Column> columns;
  for (int k = 0; k < part.n_v(); ++k) {
    Column column{model.velocity_name(part.v0 + k), "", ""};
    if (k < 3)
      column.unit = "m/s", column.meaning = "velocity of the frame, world";
    else if (k < 6)
      column.unit = "rad/s", column.meaning = "angular velocity, body frame";
    else if (k >= 6 + part.n_s)
      column.unit = std::string(part.local->unit(k - 6 - part.n_s)) + "/s";
    else
      column.unit = std::string(dynamic_parameter(part, k - 6).unit()) + "/s";
    columns.push_back(std::move(column));
  }
  return columns;
}

std::vector<Column> mode_columns_of(const Model& model) {
  std::vector<Column> columns{
      {"start", "s", "time of step 0"},
      {"step_size", "s", "step; where errors are controlled, the next one"},
      {"step", "1", "steps since start"},
      {"error", "1", "of the last step, in tolerances; 0 where it is not measured"},
      {"contact_residual", "m/s", "what impulses missed of the laws of contact in the last step"},
      {"supports", "1", "the first row of supports.npy that is of this state"},
      {"supports_end", "1", "the row after the last"},
      {"supports_age", "1", "steps in a row whose search for impulses began at them"}};
  for (const char* work : kWorkNames) columns.push_back({std::string("work.") + work, "J", "work so far"});
  for (const PartModel& part : model.parts()) {
    if (part.q0 < 0) continue;
    for (int k = 0; k < part.n_s; ++k)
      columns.push_back({"limit." + model.coordinate_name(part.q0 + 7 + k), "1",
                         "-1 at its lower limit, 1 at its upper, 0 free"});
  }
  if (model.n_resting() > 0)
    for (const PartModel& part : model.parts())
      columns.push_back(
          {"rest." + part.part->name(), "s", "how long it has been at rest; negative: it sleeps"});
  for (const JointModel& joint : model.joints())
    columns.push_back({"joint." + joint.joint->name(), "1", "0 off, 1 closing, 2 closed, 3 slack"});
  columns.push_back({"check", "1", "hash of the bits of the state"});
  return columns;
}

std::vector<Column> contact_cache_columns() {
  return {{"a", "1", "number of the part that the force is on"},
          {"b", "1", "of the other part; -1: none"},
          {"plane", "1", "or of the plane"},
          {"obstacle", "1", "or of the obstacle"},
          {"x", "m", "where it was, in the frame of part a"},
          {"y", "m", ""},
          {"z", "m", ""},
          {"force_x", "N", "mean of the last step or its second half, on part a, world"},
          {"force_y", "N", ""},
          {"force_z", "N", ""}};
}

std::vector<double> cached_contact_row(const CachedContact& support) {
  std::vector<double> row(support.between.begin(), support.between.end());
  row.insert(row.end(), support.x.data(), support.x.data() + 3);
  row.insert(row.end(), support.force.data(), support.force.data() + 3);
  return row;
}

bool read_cached_contact(const double* row, CachedContact& support) {
  for (std::size_t i = 0; i < support.between.size(); ++i) {
    if (!(row[i] >= -1 && row[i] <= std::numeric_limits<int>::max() && row[i] == std::floor(row[i])))
      return false;
    support.between[i] = static_cast<int>(row[i]);
  }
  support.x = Vec3<double>(row[4], row[5], row[6]);
  support.force = Vec3<double>(row[7], row[8], row[9]);
  return true;
}

void write_modes(const State& state, std::int64_t end_of_cached_contacts, std::vector<double>& row) {
  row.clear();
  row.push_back(state.start);
  row.push_back(state.h);
  row.push_back(static_cast<double>(state.step));
  row.push_back(state.error);
  row.push_back(state.contact_residual);
  row.push_back(static_cast<double>(end_of_cached_contacts) -
                static_cast<double>(state.contact_cache.size()));
  row.push_back(static_cast<double>(end_of_cached_contacts));
  row.push_back(state.contact_cache_age);
  row.insert(row.end(), state.work.data(), state.work.data() + kWorks);
  for (const std::int8_t at : state.at_limit) row.push_back(at);
  row.insert(row.end(), state.at_rest.begin(), state.at_rest.end());
  for (const JointMode mode : state.joints) row.push_back(static_cast<double>(mode));
  row.push_back(check_of(state));
}

bool read_modes(const std::vector<double>& row, int n_limits, std::size_t n_resting, State& state) {
  constexpr std::size_t age = kEndOfCachedContacts + 1, first_work = age + 1,
                        first_limit = first_work + kWorks;
  const std::size_t first_resting = first_limit + static_cast<std::size_t>(n_limits),
                    first_joint = first_resting + n_resting;
  if (row.size() < first_joint + 1 || !(std::abs(row[2]) < 0x1p53)) return false;
  state.start = row[0];
  state.h = row[1];
  state.step = static_cast<std::int64_t>(row[2]);
  state.error = row[3];
  state.contact_residual = row[4];
  if (!(row[age] >= 0 && row[age] < std::numeric_limits<int>::max() && row[age] == std::floor(row[age])))
    return false;
  state.contact_cache_age = static_cast<int>(row[age]);
  for (int i = 0; i < kWorks; ++i) state.work[i] = row[first_work + static_cast<std::size_t>(i)];
  state.at_limit.clear();
  for (std::size_t i = first_limit; i < first_resting; ++i) {
    if (!(row[i] == -1 || row[i] == 0 || row[i] == 1)) return false;
    state.at_limit.push_back(static_cast<std::int8_t>(row[i]));
  }
  state.at_rest.assign(row.begin() + static_cast<std::ptrdiff_t>(first_resting),
                       row.begin() + static_cast<std::ptrdiff_t>(first_joint));
  state.joints.clear();
  for (std::size_t i = first_joint; i + 1 < row.size(); ++i) {
    if (!(row[i] == 0 || row[i] == 1 || row[i] == 2 || row[i] == 3)) return false;
    state.joints.push_back(static_cast<JointMode>(row[i]));
  }
  return check_of(state) == row.back();
}

}  // namespace pliant
