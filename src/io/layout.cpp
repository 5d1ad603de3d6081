#include <pliant/io/layout.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/io/contact_recording.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/state_row.h>
#include <pliant/io/work_row.h>

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;
using Each = ColumnGroup::Each;

constexpr const char* kParts = "parts";
constexpr const char* kJoints = "joints";

/// The index in a column name such as "*.d[12].x": the position, length and text of its number.
struct NameIndex {
  std::size_t begin = std::string::npos, length = 0;
  std::string number;
};
NameIndex index_in(const std::string& name) {
  const std::size_t open = name.find('['), close = name.find(']', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  return {open + 1, close - open - 1, name.substr(open + 1, close - open - 1)};
}

/// Returns the number of columns from `first` on that differ only in an index that counts from 0; 1 if the
/// column has no such index.
std::size_t series_length(const std::vector<Column>& columns, std::size_t first) {
  const Column& start = columns[first];
  const NameIndex index = index_in(start.name);
  if (index.number != "0") return 1;
  std::size_t count = 1;
  for (; first + count < columns.size(); ++count) {
    const Column& column = columns[first + count];
    std::string expected = start.name;
    expected.replace(index.begin, index.length, std::to_string(count));
    if (column.name != expected || column.unit != start.unit || column.meaning != start.meaning) break;
  }
  return count;
}

Json json_of(const std::vector<Column>& columns) {
  Json list = Json::array();
  for (std::size_t i = 0; i < columns.size();) {
    const Column& column = columns[i];
    const std::size_t count = series_length(columns, i);
    std::string name = column.name;
    if (count > 1) {
      const NameIndex index = index_in(name);
      name.replace(index.begin, index.length, "#");
    }
    Json entry{{"name", name}};
    if (count > 1) entry["count"] = count;
    entry["unit"] = column.unit;
    if (!column.meaning.empty()) entry["meaning"] = column.meaning;
    list.push_back(std::move(entry));
    i += count;
  }
  return list;
}

Json json_of(const TableColumns& table) {
  Json list = Json::array();
  for (const ColumnGroup& group : table) {
    if (group.each == Each::table)
      for (Json& entry : json_of(group.columns(0))) list.push_back(std::move(entry));
    else
      list.push_back({{"each", group.each == Each::part ? kParts : kJoints}, {"columns", group.set}});
  }
  return list;
}

Json table_json(std::vector<Column> columns) {
  return json_of(TableColumns{table_group(std::move(columns))});
}

/// The kinds of parts and joints. Parts or joints of one kind have the same columns in all tables.
class Kinds {
 public:
  Kinds(const Model& model, std::vector<TableColumns> tables) : model_(&model) {
    for (TableColumns& table : tables)
      for (ColumnGroup& group : table)
        if (group.each != Each::table) groups_.push_back(std::move(group));
  }

  /// Returns the number of the kind of a part or joint, and adds the kind if it is new.
  std::size_t kind(Each each, std::size_t owner) {
    std::vector<std::pair<const std::string*, std::vector<Column>>> sets;
    std::string key;
    for (const ColumnGroup& group : groups_) {
      if (group.each != each) continue;
      sets.emplace_back(&group.set, group.columns(owner));
      key += group.set;
      for (const Column& column : sets.back().second)
        (((((key += '\n') += column.name) += '\n') += column.unit) += '\n') += column.meaning;
      key += "\n\n";
    }
    const auto [known, is_new] = numbers_.emplace(std::move(key), numbers_.size());
    if (is_new) {
      Json kind = Json::object();
      for (const auto& [set, columns] : sets) kind[*set] = json_of(columns);
      kinds_.push_back(std::move(kind));
    }
    return known->second;
  }
  /// Returns the columns of all kinds so far.
  const Json& json() const { return kinds_; }
  /// Returns the lines [name, kind] of all joints, or [name, kind, first column in q.npy, first column in
  /// v.npy] of all parts, as a JSON list.
  std::string list(Each each) {
    std::string text = "[";
    for (std::size_t i = 0; i < owner_count(*model_, each); ++i) {
      text += (i == 0 ? "\n  [" : ",\n  [") + Json(owner_name(*model_, each, i)).dump() + ", " +
              std::to_string(kind(each, i));
      if (each == Each::part)
        text += ", " + std::to_string(model_->parts()[i].q0) + ", " + std::to_string(model_->parts()[i].v0);
      text += ']';
    }
    return text + "\n ]";
  }

 private:
  const Model* model_;
  std::vector<ColumnGroup> groups_;
  std::map<std::string, std::size_t> numbers_;
  Json kinds_ = Json::array();
};

Json format_of(const Model& model, const FrameSchedule& schedule) {
  Json layout;
  layout["format"] = "pliant recording";
  layout["version"] = kRecordingVersion;
  layout["rows"] =
      std::string("one row per state; row i of ") + kTimesFile + ", " + kCoordinatesFile + ", " +
      kVelocitiesFile + ", " + kModesFile + ", " + kWorkFile + " and " + kTrajectoryFile +
      " is state i; the number of states is the smallest number of rows of these .npy tables and of " +
      kChecksumsFile + ", without the last states whose rows of " + kContactCacheFile + " are missing";
  layout["frames"] = {
      {"rate", schedule.rate()},
      {"count", schedule.frames()},
      {"time",
       "frame k is at time k / rate seconds: a recorded state, or computed from the recorded states at the "
       "start and at the end of the step that contains it"}};
  layout["columns"] =
      "an entry with \"name\" is a column, or \"count\" columns with # = 0, 1, ... in the name; an entry "
      "with \"each\" is a set of columns for each item of the list \"parts\" or \"joints\", in order: in the "
      "kind of the item, the list whose name is \"columns\", with the name of the item in place of *";
  layout["owners"] =
      "parts: name, kind, first column in q.npy and in v.npy, -1 for a part without columns; joints: name, "
      "kind; the kind is the index in \"kinds\"";
  if (model.body().contact.active)
    layout["support_rows"] =
        "zero or more rows per state: from row `supports` up to, but not including, row `supports_end`, "
        "which are columns of modes.npy; rows are counted from 0";
  return layout;
}

}  // namespace

void write_layout(const std::filesystem::path& folder, const Model& model, const FrameSchedule& schedule,
                  const TableColumns& trajectory, bool contacts) {
  const std::vector<std::pair<const char*, TableColumns>> state_tables{
      {kCoordinatesFile, coordinate_columns(model)},
      {kVelocitiesFile, velocity_columns(model)},
      {kModesFile, mode_columns(model, schedule.step() == 0 && model.forms_clusters())},
      {kTrajectoryFile, trajectory}};
  Json layout = format_of(model, schedule);
  Json& tables = layout["tables"];
  tables[kTimesFile] = table_json({{"t", "s", "time: start + step * step_size"}});
  for (const auto& [file, columns] : state_tables) tables[file] = json_of(columns);
  tables[kWorkFile] = table_json(work_columns());
  if (model.body().contact.active) tables[kContactCacheFile] = table_json(contact_cache_columns());
  tables[kChecksumsFile] = table_json(checksum_columns(checked_tables(model)));
  if (contacts) {
    for (const char* file : {kContactsFile, kContactsTable}) tables[file] = table_json(contact_columns());
    for (const char* file : {kJointImpulsesFile, kJointImpulsesTable})
      tables[file] = table_json(joint_impulse_columns());
    tables[kContactChecksumsFile] = table_json(checksum_columns(checked_contact_tables()));
    layout["contact_rows"] =
        "zero or more rows per state, with the time of the state; they describe the step that ends at this "
        "time; if impacts divide the step into sections, a contact has a row for each section";
  }
  std::vector<TableColumns> all;
  for (const auto& entry : state_tables) all.push_back(entry.second);
  Kinds kinds(model, std::move(all));
  const std::string parts = kinds.list(Each::part), joints = kinds.list(Each::joint);
  layout["kinds"] = kinds.json();
  std::string text = layout.dump(1);
  text.resize(text.size() - 2);  // without the last brace, which follows the lists
  WholeFile file(folder / kLayoutFile);
  file.write(text);
  file.write(std::string(",\n \"") + kParts + "\": ");
  file.write(parts);
  file.write(std::string(",\n \"") + kJoints + "\": ");
  file.write(joints);
  file.write("\n}\n");
  file.become_target(Durable::yes);
}

namespace {

/// Calls visit(name) for each column of a list in layout.json, with the name of a part or joint for *.
void visit_columns(const nlohmann::json& list, const std::string& owner,
                   const std::function<void(const std::string&)>& visit) {
  for (const nlohmann::json& entry : list) {
    const std::string& pattern = entry.at("name").get_ref<const std::string&>();
    const auto place = entry.contains("count") ? pattern.find('#') : std::string::npos;
    const int count = place == std::string::npos ? 1 : entry.at("count").get<int>();
    for (int i = 0; i < count; ++i) {
      std::string name = pattern;
      if (place != std::string::npos) name.replace(place, 1, std::to_string(i));
      visit(with_owner(std::move(name), owner));
    }
  }
}

/// Throws RecordingMismatch if the columns of a table of parts in layout.json differ from the columns of the
/// model. count: number of columns of the model. expected: returns the name of a column of the model.
void compare_columns(const nlohmann::json& layout, const char* table, int count,
                     const std::filesystem::path& file, const std::function<std::string(int)>& expected) {
  const std::string before = file.string() + " was recorded from another scene: ";
  int columns = 0;
  for (const nlohmann::json& group : layout.at("tables").at(table)) {
    const std::string& set = group.at("columns").get_ref<const std::string&>();
    for (const nlohmann::json& owner : layout.at(group.at("each").get_ref<const std::string&>()))
      visit_columns(layout.at("kinds").at(owner.at(1).get<std::size_t>()).at(set),
                    owner.at(0).get_ref<const std::string&>(), [&](const std::string& name) {
                      if (columns == count)
                        throw RecordingMismatch(before + table + " has more than the " +
                                                std::to_string(count) + " columns of this scene");
                      if (name != expected(columns))
                        throw RecordingMismatch(before + "column " + std::to_string(columns) + " of " +
                                                table + " is " + name + ", and in this scene " +
                                                expected(columns));
                      ++columns;
                    });
  }
  if (columns != count)
    throw RecordingMismatch(before + table + " has " + std::to_string(columns) +
                            " columns, and this scene needs " + std::to_string(count));
}

}  // namespace

void compare_layout(const std::filesystem::path& folder, const Model& model) {
  const std::filesystem::path file = folder / kLayoutFile;
  if (!std::filesystem::exists(file))
    throw RecordingMismatch("there is no recording: " + file.string() + " is missing");
  try {
    const nlohmann::json layout = nlohmann::json::parse(read_whole_file(file));
    if (layout.at("version") != kRecordingVersion)
      throw RecordingMismatch(file.string() + " has version " + layout.at("version").dump() +
                              ", and this program reads version " + std::to_string(kRecordingVersion) +
                              " only. Read the recording with the program that wrote it (\"build\" in " +
                              kRunFile + "), or simulate again with --force");
    compare_columns(layout, kCoordinatesFile, model.n_q(), file,
                    [&](int i) { return model.coordinate_name(i); });
    compare_columns(layout, kVelocitiesFile, model.n_v(), file,
                    [&](int i) { return model.velocity_name(i); });
  } catch (const nlohmann::json::exception& fault) {
    throw RecordingMismatch(file.string() + " is damaged: " + fault.what());
  }
}

}  // namespace pliant
