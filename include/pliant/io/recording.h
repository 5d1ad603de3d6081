// The recording of a run: every entry of the recorded states, in tables of doubles (t.npy, q.npy, v.npy, and
// modes.npy for step count, works, limit flags and a check number; supports.npy, where bodies may touch, for
// what contacts begin with). A recorded state is a state after a step, never an interpolated one, and going
// on from any of them gives the same bits. layout.json names every column.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/io/format/column.h>
#include <pliant/io/format/npy.h>
#include <pliant/io/frame_schedule.h>

namespace pliant {

/// A recording that is damaged or belongs to another model; the message names what differs.
class RecordingMismatch : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes the names and units of all columns, those of trajectory.csv (its TrajectoryTable's) too, those of
/// contacts.csv where there is one, and when frames are taken. Throws std::system_error.
void write_layout(const std::filesystem::path& folder, const Model& model, const FrameSchedule& schedule,
                  const std::vector<Column>& trajectory, bool contacts = false);

/// Appends states. Members throw std::system_error when a file cannot be written.
class RecordingWriter {
 public:
  /// New tables in a folder that holds none.
  static RecordingWriter create(const std::filesystem::path& folder, const Model& model);
  /// Goes on after the first `rows` states of the recording in a folder; later ones are cut off.
  static RecordingWriter resume(const std::filesystem::path& folder, const Model& model, std::int64_t rows);

  void append(const State& state);
  /// Everything appended so far is in the files: it outlives the process, and with to_disk a power cut.
  void flush(bool to_disk = false);
  std::int64_t rows() const { return times_.rows(); }
  std::size_t pending_bytes() const;

 private:
  RecordingWriter(NpyWriter times, NpyWriter coordinates, NpyWriter velocities, NpyWriter modes,
                  std::optional<NpyWriter> contact_cache);

  NpyWriter times_, coordinates_, velocities_, modes_;
  std::optional<NpyWriter> contact_cache_;
  std::vector<double> row_;
};

/// Reads states. The number of rows is fixed when it is opened.
class Recording {
 public:
  /// Throws std::system_error when a file cannot be read, RecordingMismatch when the columns are not those of
  /// the model.
  Recording(const std::filesystem::path& folder, const Model& model);

  std::int64_t rows() const { return static_cast<std::int64_t>(times_.size()); }
  double time(std::int64_t row) const { return times_[static_cast<std::size_t>(row)]; }
  /// A state as it was recorded, to the last bit. Throws RecordingMismatch when its check number does not
  /// fit.
  State state(std::int64_t row) const;
  /// The state at a time (s): the recorded one where there is one, else q by cubic Hermite interpolation from
  /// q and v of the states around it, v linearly. Of steps to a tolerance it is that of a step of order 8
  /// from the state before, where such a step leads to the state after it, else q is quintic, from the
  /// accelerations too. For pictures and meshes, not to go on from. Times outside the recording give its
  /// first or last state. Throws RecordingMismatch, std::out_of_range when it is empty.
  State at(double time) const;

 private:
  const Model* model_;
  NpyReader coordinates_, velocities_, modes_;
  std::optional<NpyReader> contact_cache_;
  std::vector<double> times_;
};

}  // namespace pliant
