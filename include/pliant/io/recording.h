// The recording of a run: the complete recorded states in tables of doubles. t.npy, q.npy and v.npy contain
// time, coordinates and velocities. modes.npy contains the other entries of a state (step, works, limits,
// joints) and a check number, work.npy the counters of the run (steps, evaluations, ...) up to each state.
// supports.npy contains the contact cache of scenes with contact, and checksums.npy the checksums of these
// tables. A recorded state is the initial state or a state after a step, never an interpolated state. A run
// resumed from a recorded state reproduces all later states bit by bit. layout.json (layout.h) names every
// column.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/io/checksums.h>
#include <pliant/io/format/npy.h>
#include <pliant/io/work_row.h>

namespace pliant {

/// Thrown for a recording that is damaged or belongs to another model; the message names the difference.
class RecordingMismatch : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns the tables of states that checksums.npy checks.
std::vector<CheckedTable> checked_tables(const Model& model);
/// Opens checksums.npy, the checksums of the tables of states. Throws std::system_error, RecordingMismatch.
ChecksumReader state_checksums(const std::filesystem::path& folder, const Model& model);

/// Appends states. Members throw std::system_error when a file cannot be written.
class RecordingWriter {
 public:
  /// Creates new tables. in_clusters: as for mode_columns() (state_row.h). Throws std::system_error if a
  /// table exists.
  static RecordingWriter create(const std::filesystem::path& folder, const Model& model,
                                bool in_clusters = false);
  /// Opens the tables in a folder and removes all states after the first `rows` states. Throws
  /// std::system_error, RecordingMismatch.
  static RecordingWriter resume(const std::filesystem::path& folder, const Model& model, std::int64_t rows);

  /// Appends a state and the counters of the run up to this state. Both stay in memory until flush().
  void append(const State& state, const RunWork& work);
  /// Writes all appended states to the files, so that the states survive a crash of the process. With
  /// to_disk, the states survive a power cut too.
  void flush(bool to_disk = false);
  std::int64_t rows() const { return tables_.times.rows(); }
  std::size_t pending_bytes() const;
  /// Returns the checksums of all tables with the states so far.
  Checksums checksums() const { return checksums_.checksums(); }

 private:
  struct Tables {
    NpyWriter times, coordinates, velocities, modes, work;
    std::optional<NpyWriter> contact_cache;
  };
  RecordingWriter(Tables tables, ChecksumWriter checksums);

  Tables tables_;
  ChecksumWriter checksums_;
  std::vector<double> row_;
};

/// Reads the states of a recording. The number of rows is fixed on opening.
class Recording {
 public:
  /// Opens a recording. Throws std::system_error if a file cannot be read, RecordingMismatch if it is damaged
  /// or its columns differ from those of the model. The numbers are not compared with their checksums.
  Recording(const std::filesystem::path& folder, const Model& model);

  /// Compares all recorded numbers with their checksums.
  Inspection inspect() const { return checksums_.inspect(); }
  /// Returns the checksums of all tables after the first `states` states.
  Checksums checksums(std::int64_t states) const { return checksums_.checksums(states); }

  /// Returns the folder of the tables.
  std::filesystem::path folder() const { return coordinates_.path().parent_path(); }
  std::int64_t rows() const { return static_cast<std::int64_t>(times_.size()); }
  double time(std::int64_t row) const { return times_[static_cast<std::size_t>(row)]; }
  /// Returns a recorded state, exact to the last bit. Throws RecordingMismatch if its check number does not
  /// match.
  State state(std::int64_t row) const;
  /// Returns the counters of the run up to a recorded state.
  RunWork work(std::int64_t row) const;
  /// Returns the state at a time (s), for pictures and meshes (not for resuming). At a recorded time, returns
  /// the recorded state. Between fixed steps, q is the cubic Hermite interpolant of q and v, and v is linear.
  /// With error control, the state between two recorded states is the result of a shorter step of dop853
  /// (order 8) from the first state, if no part deforms locally and a full step of dop853 leads to the second
  /// state. Otherwise q is the quintic interpolant of q, v and the accelerations, and v is linear; README.md
  /// of this folder describes the exceptions for impacts and contact. Times outside the recording give its
  /// first or last state. Throws RecordingMismatch; std::out_of_range if the recording is empty.
  State at(double time) const;

 private:
  const Model* model_;
  NpyReader coordinates_, velocities_, modes_, work_;
  std::optional<NpyReader> contact_cache_;
  ChecksumReader checksums_;
  std::vector<double> times_;
};

}  // namespace pliant
