// layout.json: the columns of all tables of a run.
#include <string>

#include <nlohmann/json.hpp>

#include <pliant/io/contact_recording.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/state_row.h>

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Column& column) {
  Json entry{{"name", column.name}, {"unit", column.unit}};
  if (!column.meaning.empty()) entry["meaning"] = column.meaning;
  return entry;
}

Json json_of(const std::vector<Column>& columns) {
  Json list = Json::array();
  for (const Column& column : columns) list.push_back(json_of(column));
  return list;
}

Json part_columns(const Model& model, bool velocities) {
  Json columns = Json::array();
  for (const PartModel& part : model.parts()) {
    if (part.q0 < 0) continue;
    for (const Column& column :
         velocities ? velocity_columns(model, part) : coordinate_columns(model, part)) {
      Json entry = json_of(column);
      entry["part"] = part.part->name();
      entry["coordinate"] = column.name.substr(part.part->name().size() + 1);
      columns.push_back(entry);
    }
  }
  return columns;
}

}  // namespace

void write_layout(const std::filesystem::path& folder, const Model& model, const FrameSchedule& schedule,
                  const std::vector<Column>& trajectory, bool contacts) {
  Json layout;
  layout["format"] = "pliant recording";
  layout["version"] = kRecordingVersion;
  layout["rows"] =
      std::string("one row per state; row i of ") + kTimesFile + ", " + kCoordinatesFile + ", " +
      kVelocitiesFile + ", " + kModesFile + " and " + kTrajectoryFile +
      " is state i; the number of states is the smallest number of rows of these .npy tables and of " +
      kChecksumsFile + ", without the last states whose rows of " + kContactCacheFile + " are missing";
  layout["frames"] = {
      {"rate", schedule.rate()},
      {"count", schedule.frames()},
      {"time",
       "frame k is at time k / rate seconds: a recorded state, or computed from the recorded states at the "
       "start and at the end of the step that contains it"}};
  Json& tables = layout["tables"];
  tables[kTimesFile] = json_of(std::vector<Column>{{"t", "s", "time: start + step * step_size"}});
  tables[kCoordinatesFile] = part_columns(model, false);
  tables[kVelocitiesFile] = part_columns(model, true);
  tables[kModesFile] = json_of(mode_columns_of(model, schedule.step() == 0 && model.forms_clusters()));
  if (model.body().contact.active) {
    tables[kContactCacheFile] = json_of(contact_cache_columns());
    layout["support_rows"] =
        "zero or more rows per state: from row `supports` up to, but not including, row `supports_end`, "
        "which "
        "are columns of modes.npy; rows are counted from 0";
  }
  tables[kChecksumsFile] = json_of(checksum_columns(checked_tables(model)));
  tables[kTrajectoryFile] = json_of(trajectory);
  if (contacts) {
    for (const char* file : {kContactsFile, kContactsTable}) tables[file] = json_of(contact_columns());
    for (const char* file : {kJointImpulsesFile, kJointImpulsesTable})
      tables[file] = json_of(joint_impulse_columns());
    tables[kContactChecksumsFile] = json_of(checksum_columns(checked_contact_tables()));
    layout["contact_rows"] =
        "zero or more rows per state, with the time of the state; they describe the step that ends at this "
        "time; if impacts divide the step into sections, a contact has a row for each section";
  }
  const std::string text = layout.dump(1) + "\n";
  write_whole_file(folder / kLayoutFile, text.data(), text.size(), Durable::yes);
}

}  // namespace pliant
