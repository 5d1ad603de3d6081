// layout.json: what the columns of the tables are.
#include <string>

#include <nlohmann/json.hpp>

#include <pliant/io/recording.h>
#include <pliant/io/run_files.h>
#include <pliant/io/state_row.h>
#include <pliant/io/whole_file.h>

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

Json column(const std::string& name, const std::string& unit, const std::string& meaning = "") {
  Json entry{{"name", name}, {"unit", unit}};
  if (!meaning.empty()) entry["meaning"] = meaning;
  return entry;
}

// "m" -> "m/s", "1" -> "1/s".
std::string rate_of(const std::string& unit) {
  return unit + "/s";
}

const Parameter& dynamic_parameter(const PartModel& part, int k) {
  const Parameters& all = part.part->parameters();
  return all[all.dynamic()[static_cast<std::size_t>(k)]];
}

Json part_columns(const Model& model, bool velocities) {
  Json columns = Json::array();
  for (const PartModel& part : model.parts()) {
    if (part.q0 < 0) continue;
    const int first = velocities ? part.v0 : part.q0, rigid = velocities ? 6 : 7;
    for (int k = 0; k < rigid + part.n_s; ++k) {
      const std::string unit = k >= rigid   ? dynamic_parameter(part, k - rigid).spec->unit
                               : k < 3      ? "m"
                               : velocities ? "rad"
                                            : "1";
      const std::string name = velocities ? model.velocity_name(first + k) : model.coordinate_name(first + k);
      Json entry = column(name, velocities ? rate_of(unit) : unit);
      entry["part"] = part.part->name();
      entry["coordinate"] = name.substr(part.part->name().size() + 1);
      columns.push_back(entry);
    }
  }
  return columns;
}

Json mode_columns(const Model& model) {
  Json columns = Json::array();
  for (const ModeColumn& mode : mode_columns_of(model))
    columns.push_back(column(mode.name, mode.unit, mode.meaning));
  return columns;
}

}  // namespace

void write_layout(const std::filesystem::path& folder, const Model& model, const FrameSchedule& schedule) {
  Json layout;
  layout["format"] = "pliant recording";
  layout["version"] = 1;
  layout["rows"] =
      "one state a row, the same row in every table; the number of states is that of the shortest table";
  layout["frames"] = {
      {"rate", schedule.rate()},
      {"count", schedule.frames()},
      {"time",
       "frame k is taken at k / rate seconds: a recorded state, or interpolated between the two states "
       "of the step around it"}};
  Json& tables = layout["tables"];
  tables[kTimesFile] = Json::array({column("t", "s", "time: start + step * step_size")});
  tables[kCoordinatesFile] = part_columns(model, false);
  tables[kVelocitiesFile] = part_columns(model, true);
  tables[kModesFile] = mode_columns(model);
  const std::string text = layout.dump(1) + "\n";
  write_whole_file(folder / kLayoutFile, text.data(), text.size(), Durable::yes);
}

}  // namespace pliant
