// Runs a scene into a folder: simulates, records, and keeps run.json true. Everything here happens without a
// GL library.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <pliant/io/contact_recording.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/contact_notes.h>
#include <pliant/io/run/progress.h>
#include <pliant/io/run/run_folder.h>
#include <pliant/io/run/run_record.h>
#include <pliant/scene/scene.h>

namespace pliant {

struct RunOptions {
  std::filesystem::path folder;
  Existing existing = Existing::refuse;
  int threads = 0;                   ///< 0: as many as the scene and the machine have a use for
  std::string scene_file;            ///< path it was read from, "-" for standard input; empty for none
  std::vector<std::string> command;  ///< the command line, for run.json
  std::string graphics;              ///< what draws pictures, for run.json; empty without
  std::function<bool()> stop;        ///< asked after every step; true ends the run in good order
};

/// A run in its folder. The scene's end, step, frame rate, integrator and picture size are what the run uses;
/// they may be changed before it begins.
class Run {
 public:
  /// Prepares the model first, then makes, locks and begins the folder (or, resuming, reads it). Throws
  /// std::invalid_argument (a bad scene), OutputRefused, RecordingMismatch (resuming another scene, build,
  /// step, method or frame rate), std::system_error. The scene must outlive the run.
  Run(Scene& scene, RunOptions options, Progress& progress);
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Steps to the end and writes trajectory.csv. False when `stop` ended it: the last state is recorded and
  /// the run can be resumed. Throws StepFailure (the last good state is then recorded),
  /// std::system_error.
  bool simulate();

  /// A stage after the simulation, its wall time and files noted in run.json: write("meshes",
  /// "meshes/frame_*.obj", ...).
  void write(const std::string& stage, const std::vector<std::string>& files,
             const std::function<void()>& task);

  /// Runs it again more exactly and notes how far the two are apart; a stage like those of write().
  const ErrorEstimate& estimate_error();

  /// Writes the last word into run.json: complete, or stopped with a message.
  void finish(RunRecord::Status status, const std::string& message = "");

  const Scene& scene() const { return *scene_; }
  const Simulation& simulation() const { return *simulation_; }
  const FrameSchedule& schedule() const { return schedule_; }
  const std::filesystem::path& folder() const { return folder_->path(); }
  const RunRecord& record() const { return record_; }
  /// The states recorded so far.
  Recording recording() const { return {folder_->path(), simulation_->model()}; }

 private:
  void begin_recording();
  void resume_recording();
  void record_state();
  bool at_end() const;
  bool take_step();
  void step_to_end();
  void flush(bool to_disk = false);
  void save(bool to_disk = false);
  /// What people read: trajectory.csv, and what touched where the scene asks for it.
  void write_tables();
  void write_record();
  void fail(const std::string& message) noexcept;
  void note(const std::string& text);
  void note_redundancy();
  void note_engagements();
  void note_turns();

  Scene* scene_;
  RunOptions options_;
  Progress* progress_;
  std::unique_ptr<Simulation> simulation_;
  FrameSchedule schedule_;
  std::unique_ptr<RunFolder> folder_;
  std::unique_ptr<RecordingWriter> writer_;
  std::unique_ptr<ContactRecordingWriter> contacts_;  // where the scene asks for them
  RunRecord record_;
  double recorded_time_ = -1;                                   // of the last recorded state
  std::size_t reported_impulses_ = 0;                           ///< of the impulses of joints that took hold
  std::set<std::string> reported_redundant_, reported_turned_;  // texts; names of parts
  std::set<TouchingPair> reported_overlaps_;
  std::vector<bool> reported_acting_;  ///< the joints that acted when redundant rows were told of
  StepCounters earlier_steps_;         // of the sessions before
  Counters earlier_counters_;
  std::chrono::steady_clock::time_point saved_;
  bool stopped_ = false;
};

/// The steps and frames of a scene.
FrameSchedule schedule_of(const Scene& scene);

/// As many threads as the parts of a scene have a use for, at most what the machine has; results do not
/// depend on it. Prepares the parts, and throws what that throws.
int automatic_threads(Scene& scene);

}  // namespace pliant
