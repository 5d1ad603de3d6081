// The contacts of the last step before each recorded state, and the reaction impulses of joints. The run
// records both in contacts.npy and joint_impulses.npy, and writes them as contacts.csv and joint_impulses.csv
// at its end. Impacts within a step divide the step into sections. For the last step before a recorded state,
// contacts.npy has one row per contact and section, and joint_impulses.npy one row per joint with an impulse.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/contact/contact_resolution.h>
#include <pliant/io/checksums.h>
#include <pliant/io/format/column.h>
#include <pliant/io/format/npy.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

/// Return the columns of contacts.csv and of joint_impulses.csv, in order. The .npy tables have the same
/// columns, with indices in place of names.
std::vector<Column> contact_columns();
std::vector<Column> joint_impulse_columns();

class ContactRecordingWriter {
 public:
  /// Creates new tables. Throws std::system_error if a table exists. All members throw std::system_error if a
  /// table cannot be written.
  static ContactRecordingWriter create(const std::filesystem::path& folder);
  /// Opens existing tables and removes their rows after the first `states` recorded states. Throws
  /// RecordingMismatch if a table is damaged.
  static ContactRecordingWriter resume(const std::filesystem::path& folder, std::int64_t states);

  /// Appends the contacts and the joint impulses of the last step of the simulation. The state at the end of
  /// this step is a recorded state. The rows stay in memory until flush().
  void append(const Simulation& simulation);
  /// Writes the rows in memory to the files. With to_disk, they survive a power cut too.
  void flush(bool to_disk = false);
  std::size_t pending_bytes() const {
    return contacts_.pending_bytes() + impulses_.pending_bytes() + checksums_.pending_bytes();
  }
  /// Returns the checksums of both tables with all rows so far.
  Checksums checksums() const { return checksums_.checksums(); }

 private:
  ContactRecordingWriter(NpyWriter contacts, NpyWriter impulses, ChecksumWriter checksums);
  void append_contacts(const Simulation& simulation, const ContactRecord& record);
  void append_joints(const Simulation& simulation, const ContactRecord& record);

  NpyWriter contacts_, impulses_;
  ChecksumWriter checksums_;
  Workspace<double> work_;
};

/// The contacts of a recording.
class RecordedContacts {
 public:
  struct Force {
    Vec3<double> at, force;  ///< contact point, m, and mean force on the first part, N; world
  };

  /// Opens the contacts of the run in a folder; nullopt if contacts were not recorded. Throws
  /// std::system_error, RecordingMismatch.
  static std::optional<RecordedContacts> open(const std::filesystem::path& folder);
  /// Returns the forces of the contacts of the last step before the recorded state at a time, s.
  std::vector<Force> at(double time) const;

 private:
  explicit RecordedContacts(NpyReader table) : table_(std::move(table)) {}

  NpyReader table_;
};

/// Opens the checksums of both tables, contact_checksums.npy. Throws std::system_error, RecordingMismatch.
ChecksumReader contact_checksums(const std::filesystem::path& folder);
/// Returns the tables that contact_checksums.npy checks.
std::vector<CheckedTable> checked_contact_tables();

/// Writes contacts.csv and joint_impulses.csv from the recorded tables. Throws std::system_error,
/// RecordingMismatch.
void write_contact_tables(const std::filesystem::path& folder, const Model& model);

}  // namespace pliant
