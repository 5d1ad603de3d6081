// What touched in the step before each recorded state, and what joints took up of it: recorded in
// contacts.npy and joint_impulses.npy as the run goes, written for people as contacts.csv and
// joint_impulses.csv when it ends. One row for each time that impulses acted at a contact in that step
// (impacts within a step have it made in parts), and one for each joint that took up some of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <pliant/io/format/column.h>
#include <pliant/io/format/npy.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

/// The columns of contacts.csv and joint_impulses.csv; in the recorded tables numbers stand for names.
std::vector<Column> contact_columns();
std::vector<Column> joint_impulse_columns();

class ContactRecordingWriter {
 public:
  /// New tables; refuses those that exist. Throws std::system_error, as the other members do.
  static ContactRecordingWriter create(const std::filesystem::path& folder);
  /// Goes on with tables, whose rows after time t (s) are cut off. Throws RecordingMismatch.
  static ContactRecordingWriter resume(const std::filesystem::path& folder, double t);

  /// What the last step of the simulation did; kept in memory until flush().
  void append(const Simulation& simulation);
  void flush(bool to_disk = false);
  std::size_t pending_bytes() const { return contacts_.pending_bytes() + impulses_.pending_bytes(); }

 private:
  ContactRecordingWriter(NpyWriter contacts, NpyWriter impulses);
  void append_joints(const Simulation& simulation, const ContactRecord& record);

  NpyWriter contacts_, impulses_;
  Workspace<double> work_;
};

/// Writes both tables for people. Throws std::system_error, RecordingMismatch.
void write_contact_tables(const std::filesystem::path& folder, const Model& model);

}  // namespace pliant
