// The contacts of the last step before each recorded state, and the reaction impulses of joints. They are
// recorded in contacts.npy and joint_impulses.npy during the run, and written as contacts.csv and
// joint_impulses.csv at its end. There is one row per contact for each part of the step (impacts within a
// step divide it into parts), and one row per joint with an impulse.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <pliant/contact/contact_resolution.h>
#include <pliant/io/format/column.h>
#include <pliant/io/format/npy.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

/// Return the columns of contacts.csv and joint_impulses.csv. The .npy tables have indices in place of names.
std::vector<Column> contact_columns();
std::vector<Column> joint_impulse_columns();

class ContactRecordingWriter {
 public:
  /// Creates new tables. Throws std::system_error if one exists or cannot be written, as the other members
  /// do.
  static ContactRecordingWriter create(const std::filesystem::path& folder);
  /// Opens existing tables and removes their rows after time t (s). Throws RecordingMismatch if they are
  /// damaged.
  static ContactRecordingWriter resume(const std::filesystem::path& folder, double t);

  /// Appends the contacts of the last step of the simulation. The rows stay in memory until flush().
  void append(const Simulation& simulation);
  void flush(bool to_disk = false);
  std::size_t pending_bytes() const { return contacts_.pending_bytes() + impulses_.pending_bytes(); }

 private:
  ContactRecordingWriter(NpyWriter contacts, NpyWriter impulses);
  void append_joints(const Simulation& simulation, const ContactRecord& record);

  NpyWriter contacts_, impulses_;
  Workspace<double> work_;
};

/// Writes contacts.csv and joint_impulses.csv from the recorded tables. Throws std::system_error,
/// RecordingMismatch.
void write_contact_tables(const std::filesystem::path& folder, const Model& model);

}  // namespace pliant
