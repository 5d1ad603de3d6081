#include <pliant/contact/contact_stepping.h>
#include <pliant/io/contact_recording.h>

#include <algorithm>
#include <string>
#include <utility>

#include <pliant/io/format/csv_cell.h>
#include <pliant/io/format/number_text.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/run_files.h>
#include <pliant/math/index.h>

namespace pliant {
namespace {

void add_axes(std::vector<Column>& columns, const std::string& stem, const char* unit, const char* meaning) {
  for (const char* axis : {".x", ".y", ".z"}) columns.push_back({stem + axis, unit, meaning});
}

void add_vector(std::vector<double>& numbers, const Vec3<double>& x) {
  numbers.insert(numbers.end(), {x[0], x[1], x[2]});
}

/// Indices of the tables of checked_contact_tables().
enum : std::size_t { kContacts, kImpulses };

/// Throws RecordingMismatch if the table has another number of columns.
void require_columns(const NpyReader& table, const std::vector<Column>& columns) {
  if (table.columns() != static_cast<int>(columns.size()))
    throw RecordingMismatch(table.path().string() + " has " + std::to_string(table.columns()) +
                            " columns, expected " + std::to_string(columns.size()));
}

/// Writes the table `from` as the CSV file `to`. The first column is the time. The next `names` columns are
/// indices into names_of and become names. Throws RecordingMismatch if the table has another number of
/// columns, or an index without a name.
void write_table(const std::filesystem::path& from, const std::filesystem::path& to,
                 const std::vector<Column>& columns, const std::vector<std::string>& names_of,
                 std::size_t names) {
  const NpyReader table(from);
  require_columns(table, columns);
  WholeFile file(to);
  std::string text;
  for (const Column& column : columns) text += (text.empty() ? "" : ",") + column.name;
  text += '\n';
  std::vector<double> row(columns.size());
  for (std::int64_t i = 0; i < table.rows(); ++i) {
    table.read(i, row.data());
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k > 0) text += ',';
      if (k < 1 || k > names) {
        append_number(text, row[k]);
        continue;
      }
      if (!(row[k] >= 0 && row[k] < static_cast<double>(names_of.size())))
        throw RecordingMismatch(from.string() + " is damaged: row " + std::to_string(i) +
                                " has the index of a part, plane, obstacle or joint that does not exist");
      text += csv_cell(names_of[static_cast<std::size_t>(row[k])]);
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

}  // namespace

std::vector<Column> contact_columns() {
  std::vector<Column> columns{
      {"t", "s", "time of the recorded state; the row is about the last step before this time"},
      {"a", "1", "first part; in the .npy table its index, from 0"},
      {"b", "1",
       "second part, plane or obstacle; in the .npy table its index, with planes after parts and obstacles "
       "after planes"}};
  add_axes(columns, "point", "m", "contact point, world");
  add_axes(columns, "normal", "1", "unit normal from b to a, world");
  columns.push_back({"gap", "m", "gap before the correction of overlaps; negative if the two overlap"});
  add_axes(columns, "impulse", "N s", "impulse on a during the step, world");
  add_axes(columns, "force", "N", "mean force on a over the step, world");
  columns.push_back({"sliding", "m/s", "tangential speed of a relative to b after the impulse"});
  return columns;
}

std::vector<Column> joint_impulse_columns() {
  std::vector<Column> columns{
      {"t", "s", "time of the recorded state; the row is about the last step before this time"},
      {"joint", "1", "joint; in the .npy table its index, from 0"}};
  add_axes(columns, "impulse", "N s",
           "reaction of the joint to contact impulses of the step, on its first side, world");
  add_axes(columns, "angular_impulse", "N m s",
           "angular reaction of the joint to contact impulses of the step, on its first side, about the "
           "joint, world");
  return columns;
}

std::vector<CheckedTable> checked_contact_tables() {
  return {{kContactsFile, false}, {kJointImpulsesFile, false}};
}

ChecksumReader contact_checksums(const std::filesystem::path& folder) {
  return {folder, kContactChecksumsFile, checked_contact_tables()};
}

ContactRecordingWriter::ContactRecordingWriter(NpyWriter contacts, NpyWriter impulses,
                                               ChecksumWriter checksums)
    : contacts_(std::move(contacts)), impulses_(std::move(impulses)), checksums_(std::move(checksums)) {}

ContactRecordingWriter ContactRecordingWriter::create(const std::filesystem::path& folder) {
  return {NpyWriter::create(folder / kContactsFile, static_cast<int>(contact_columns().size())),
          NpyWriter::create(folder / kJointImpulsesFile, static_cast<int>(joint_impulse_columns().size())),
          ChecksumWriter::create(folder / kContactChecksumsFile, checked_contact_tables())};
}

ContactRecordingWriter ContactRecordingWriter::resume(const std::filesystem::path& folder,
                                                      std::int64_t states) {
  const ChecksumReader checksums = contact_checksums(folder);
  auto resume_table = [&](std::size_t table, const char* name, const std::vector<Column>& columns) {
    try {
      return NpyWriter::resume(folder / name, static_cast<int>(columns.size()),
                               checksums.rows(table, states));
    } catch (const std::system_error&) {
      throw;
    } catch (const RecordingMismatch&) {
      throw;
    } catch (const std::runtime_error& fault) {
      throw RecordingMismatch(fault.what());
    }
  };
  return {resume_table(kContacts, kContactsFile, contact_columns()),
          resume_table(kImpulses, kJointImpulsesFile, joint_impulse_columns()),
          ChecksumWriter::resume(folder / kContactChecksumsFile, checked_contact_tables(), states)};
}

namespace {

/// Returns the index of the second side of a contact (a part, plane or obstacle) in the list of all parts,
/// then planes, then obstacles.
int number_of_other_thing(const Model& model, const Contact& contact) {
  const std::size_t parts = model.parts().size(), planes = model.body().contact.planes.size();
  if (contact.b.part >= 0) return contact.b.part;
  if (contact.plane >= 0) return static_cast<int>(parts) + contact.plane;
  return static_cast<int>(parts + planes) + contact.obstacle;
}

}  // namespace

void ContactRecordingWriter::append(const Simulation& simulation) {
  if (simulation.contact() != nullptr) {
    const ContactRecord& record = simulation.contact()->record();
    append_contacts(simulation, record);
    append_joints(simulation, record);
  }
  checksums_.end_state();
}

void ContactRecordingWriter::append_contacts(const Simulation& simulation, const ContactRecord& record) {
  std::vector<double> row;
  for (std::size_t k = 0; k < record.contacts.size(); ++k) {
    const Contact& contact = record.contacts[k];
    const int b = number_of_other_thing(simulation.model(), contact);
    row = {simulation.time(), static_cast<double>(contact.a.part), static_cast<double>(b)};
    add_vector(row, contact.x);
    add_vector(row, contact.normal);
    row.push_back(contact.gap);
    add_vector(row, record.impulses[k]);
    add_vector(row, record.impulses[k] / record.time[k]);
    row.push_back(record.sliding[k]);
    contacts_.append(row.data());
    checksums_.add(kContacts, row.data(), row.size());
  }
}

void ContactRecordingWriter::append_joints(const Simulation& simulation, const ContactRecord& record) {
  const Model& model = simulation.model();
  const State& state = simulation.state();
  std::vector<double> row;
  for (const Island& island : model.islands()) {
    auto has_impulse = [&](int j) {
      const JointModel& joint = model.joints()[at(j)];
      return !record.joint_impulses.segment(joint.row, joint.rows).isZero(0);
    };
    if (std::none_of(island.joints.begin(), island.joints.end(), has_impulse)) continue;
    simulation.dynamics().evaluate_joints(state.time(), state.q, state.v, state.joints, island, work_);
    for (const int j : island.joints) {
      if (!has_impulse(j)) continue;
      const Wrench wrench = simulation.dynamics().joint_wrench(state.time(), j, work_, record.joint_impulses);
      row = {state.time(), static_cast<double>(j)};
      add_vector(row, wrench.force);
      add_vector(row, wrench.torque);
      impulses_.append(row.data());
      checksums_.add(kImpulses, row.data(), row.size());
    }
  }
}

void ContactRecordingWriter::flush(bool to_disk) {
  for (NpyWriter* table : {&contacts_, &impulses_}) to_disk ? table->flush_to_disk() : table->flush();
  to_disk ? checksums_.flush_to_disk() : checksums_.flush();
}

std::optional<RecordedContacts> RecordedContacts::open(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / kContactsFile)) return {};
  NpyReader table(folder / kContactsFile);
  require_columns(table, contact_columns());
  return RecordedContacts(std::move(table));
}

std::vector<RecordedContacts::Force> RecordedContacts::at(double time) const {
  const std::vector<Column> columns = contact_columns();
  const auto column = [&](const char* name) {
    const auto found =
        std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
    return found - columns.begin();
  };
  const auto point = column("point.x"), force = column("force.x");
  std::vector<double> row(columns.size());
  std::int64_t low = 0, high = table_.rows();  // the first row of this time is in [low, high]
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    table_.read(middle, row.data());
    (row[0] < time ? low : high) = row[0] < time ? middle + 1 : middle;
  }
  std::vector<Force> forces;
  for (; low < table_.rows(); ++low) {
    table_.read(low, row.data());
    if (row[0] != time) break;
    forces.push_back({Vec3<double>(row.data() + point), Vec3<double>(row.data() + force)});
  }
  return forces;
}

void write_contact_tables(const std::filesystem::path& folder, const Model& model) {
  std::vector<std::string> things, joints;
  for (const PartModel& m : model.parts()) things.push_back(m.part->name());
  for (const ContactPlane& plane : model.body().contact.planes) things.push_back(plane.name);
  for (const ContactObstacle& obstacle : model.body().contact.obstacles) things.push_back(obstacle.name);
  for (const JointModel& joint : model.joints()) joints.push_back(joint.joint->name());
  write_table(folder / kContactsFile, folder / kContactsTable, contact_columns(), things, 2);
  write_table(folder / kJointImpulsesFile, folder / kJointImpulsesTable, joint_impulse_columns(), joints, 1);
}

}  // namespace pliant
