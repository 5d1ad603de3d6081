#include <pliant/io/state_row.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace pliant {
namespace {

/// Number of columns of a StepMemory.
constexpr std::size_t kMemoryColumns = 4;

/// Returns the upper 53 bits of the hash of a state, which a double represents exactly.
double check_of(const State& state) {
  return static_cast<double>(hash(state) >> 11);
}

const ParameterSpec& dynamic_parameter(const PartModel& part, int k) {
  return *part.part->parameters().moving(k).spec;
}

/// Returns "*.NAME" for the name "PART.NAME" of a coordinate or velocity of a part.
std::string pattern_of(const PartModel& part, const std::string& name) {
  return '*' + name.substr(part.part->name().size());
}

}  // namespace

std::vector<Column> coordinate_columns(const Model& model, const PartModel& part) {
  std::vector<Column> columns;
  for (int k = 0; part.q0 >= 0 && k < part.n_q(); ++k) {
    Column column{pattern_of(part, model.coordinate_name(part.q0 + k)), "", ""};
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
  for (int k = 0; part.v0 >= 0 && k < part.n_v(); ++k) {
    Column column{pattern_of(part, model.velocity_name(part.v0 + k)), "", ""};
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

namespace {

/// Returns the columns of the limits of the dynamic parameters of a part in modes.npy.
std::vector<Column> limit_columns(const Model& model, const PartModel& part) {
  std::vector<Column> columns;
  for (int k = 0; part.q0 >= 0 && k < part.n_s; ++k)
    columns.push_back({"limit." + pattern_of(part, model.coordinate_name(part.q0 + 7 + k)), "1",
                       "-1 at the lower limit, 1 at the upper limit, 0 free"});
  return columns;
}

std::vector<Column> cluster_columns() {
  return {{"step_size.*", "s", "length of the next step of the cluster of the part"},
          {"error.*", "1", "error of the last step of the cluster of the part / tolerance"},
          {"contact_residual.*", "m/s", "residual of the contact laws in the last step of the cluster"},
          {"supports_age.*", "1", "consecutive steps of the cluster of the part with a warm start"}};
}

/// Returns the first columns of modes.npy, which do not depend on the model.
std::vector<Column> common_mode_columns() {
  std::vector<Column> columns{
      {"start", "s", "time of step 0"},
      {"step_size", "s", "length of a step; with error control, of the next step"},
      {"step", "1", "steps since start"},
      {"error", "1", "error of the last step / tolerance; 0 without error control"},
      {"contact_residual", "m/s", "residual of the contact laws in the last step"},
      {"supports", "1", "first row of this state in supports.npy (its contact cache)"},
      {"supports_end", "1", "one past the last row of this state in supports.npy"},
      {"supports_age", "1", "number of consecutive steps with a warm start from the contact cache"}};
  for (const char* work : kWorkNames) columns.push_back({std::string("work.") + work, "J", "work so far"});
  return columns;
}

}  // namespace

TableColumns coordinate_columns(const Model& model) {
  return {{ColumnGroup::Each::part, "coordinates",
           [&model](std::size_t i) { return coordinate_columns(model, model.parts()[i]); }}};
}

TableColumns velocity_columns(const Model& model) {
  return {{ColumnGroup::Each::part, "velocities",
           [&model](std::size_t i) { return velocity_columns(model, model.parts()[i]); }}};
}

TableColumns mode_columns(const Model& model, bool in_clusters) {
  using Each = ColumnGroup::Each;
  TableColumns columns{table_group(common_mode_columns())};
  columns.push_back(
      {Each::part, "limits", [&model](std::size_t i) { return limit_columns(model, model.parts()[i]); }});
  if (model.n_resting() > 0)
    columns.push_back(
        {Each::part, "rest", [](std::size_t) {
           return std::vector<Column>{{"rest.*", "s", "time at rest; negative: the part sleeps"}};
         }});
  if (in_clusters) columns.push_back({Each::part, "cluster", [](std::size_t) { return cluster_columns(); }});
  columns.push_back({Each::joint, "mode", [](std::size_t) {
                       return std::vector<Column>{{"joint.*", "1", "0 off, 1 closing, 2 closed, 3 slack"}};
                     }});
  columns.push_back(table_group({{"check", "1", "upper 53 bits of a hash of the state"}}));
  return columns;
}

std::size_t mode_count(const Model& model, bool in_clusters) {
  return kEndOfCachedContacts + 2 + kWorks + static_cast<std::size_t>(model.n_limits()) + model.n_resting() +
         (in_clusters ? kMemoryColumns * model.parts().size() : 0) + model.joints().size() + 1;
}

std::vector<Column> contact_cache_columns() {
  return {{"a", "1", "index of the first part"},
          {"b", "1", "index of the second part; -1: none"},
          {"plane", "1", "index of the plane; -1: none"},
          {"obstacle", "1", "index of the obstacle; -1: none"},
          {"x", "m", "contact point, in the frame of part a"},
          {"y", "m", ""},
          {"z", "m", ""},
          {"force_x", "N",
           "mean force on part a in the last step (with step doubling: in its last half or third), world"},
          {"force_y", "N", ""},
          {"force_z", "N", ""},
          {"lasting", "1", "1 if this force acted during the whole step, else 0"}};
}

std::vector<double> cached_contact_row(const CachedContact& contact) {
  std::vector<double> row(contact.between.begin(), contact.between.end());
  row.insert(row.end(), contact.x.data(), contact.x.data() + 3);
  row.insert(row.end(), contact.force.data(), contact.force.data() + 3);
  row.push_back(contact.lasting ? 1 : 0);
  return row;
}

bool read_cached_contact(const double* row, CachedContact& contact) {
  for (std::size_t i = 0; i < contact.between.size(); ++i) {
    if (!(row[i] >= -1 && row[i] <= std::numeric_limits<int>::max() && row[i] == std::floor(row[i])))
      return false;
    contact.between[i] = static_cast<int>(row[i]);
  }
  contact.x = Vec3<double>(row[4], row[5], row[6]);
  contact.force = Vec3<double>(row[7], row[8], row[9]);
  contact.lasting = row[10] == 1;
  return row[10] == 0 || row[10] == 1;
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
  for (const StepMemory& memory : state.step_memory)
    row.insert(row.end(), {memory.h, memory.error, memory.contact_residual,
                           static_cast<double>(memory.contact_cache_age)});
  for (const JointMode mode : state.joints) row.push_back(static_cast<double>(mode));
  row.push_back(check_of(state));
}

bool read_modes(const std::vector<double>& row, const Model& model, State& state) {
  constexpr std::size_t age = kEndOfCachedContacts + 1, first_work = age + 1,
                        first_limit = first_work + kWorks;
  const std::size_t first_resting = first_limit + static_cast<std::size_t>(model.n_limits()),
                    first_memory = first_resting + model.n_resting(), n_after = model.joints().size() + 1;
  if (row.size() < first_memory + n_after) return false;
  const std::size_t first_joint = row.size() - n_after,
                    n_memory = (first_joint - first_memory) / kMemoryColumns;
  if (first_memory + kMemoryColumns * n_memory != first_joint) return false;
  if (!(std::abs(row[2]) < 0x1p53)) return false;
  state.start = row[0];
  state.h = row[1];
  state.step = static_cast<std::int64_t>(row[2]);
  state.error = row[3];
  state.contact_residual = row[4];
  auto is_age = [](double number) {
    return number >= 0 && number < std::numeric_limits<int>::max() && number == std::floor(number);
  };
  if (!is_age(row[age])) return false;
  state.contact_cache_age = static_cast<int>(row[age]);
  for (int i = 0; i < kWorks; ++i) state.work[i] = row[first_work + static_cast<std::size_t>(i)];
  state.at_limit.clear();
  for (std::size_t i = first_limit; i < first_resting; ++i) {
    if (!(row[i] == -1 || row[i] == 0 || row[i] == 1)) return false;
    state.at_limit.push_back(static_cast<std::int8_t>(row[i]));
  }
  state.at_rest.assign(row.begin() + static_cast<std::ptrdiff_t>(first_resting),
                       row.begin() + static_cast<std::ptrdiff_t>(first_memory));
  state.step_memory.clear();
  for (std::size_t i = first_memory; i < first_joint; i += kMemoryColumns) {
    if (!is_age(row[i + 3])) return false;
    state.step_memory.push_back({row[i], row[i + 1], row[i + 2], static_cast<int>(row[i + 3])});
  }
  state.joints.clear();
  for (std::size_t i = first_joint; i + 1 < row.size(); ++i) {
    if (!(row[i] == 0 || row[i] == 1 || row[i] == 2 || row[i] == 3)) return false;
    state.joints.push_back(static_cast<JointMode>(row[i]));
  }
  return check_of(state) == row.back();
}

}  // namespace pliant
