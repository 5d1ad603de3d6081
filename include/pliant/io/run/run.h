// Running a scene into a folder: simulation, recording, and the run record run.json. No graphics library is
// needed.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <pliant/io/contact_recording.h>
#include <pliant/io/frame_schedule.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/contact_notes.h>
#include <pliant/io/run/progress.h>
#include <pliant/io/run/run_folder.h>
#include <pliant/io/run/run_record.h>
#include <pliant/io/track_sampling.h>
#include <pliant/scene/scene.h>
#include <pliant/simulate/energy_monitor.h>
#include <pliant/simulate/stable_step.h>

namespace pliant {

/// Wall time between two checkpoints, s, unless RunOptions gives another time.
inline constexpr double kStandardCheckpointInterval = 30;

struct RunOptions {
  std::filesystem::path folder;
  Existing existing = Existing::refuse;
  int threads = 0;                   ///< 0: chosen by automatic_threads()
  std::string scene_file;            ///< path of the scene, "-" for standard input; empty for none
  std::vector<std::string> command;  ///< the command line, for run.json
  std::string graphics;              ///< graphics library, for run.json; empty without pictures
  /// Wall time, s. The limit for all trials together after a failure (find_remedy()) is three times the wall
  /// time of the failed run, but at least remedy_seconds, and at most ten times remedy_seconds.
  double remedy_seconds = 2;
  /// Wall time between two checkpoints, s; with 0, a checkpoint is written after every step.
  double checkpoint_every = kStandardCheckpointInterval;
  /// Called before every step; true ends the run so that it can be resumed. Also called while the method of
  /// integration is chosen and while a resumed run reads its states; true then ends the constructor of Run.
  std::function<bool()> stop;
};

/// A run in its folder. The run uses end, step, tolerance, frame rate, integrator and picture size of the
/// scene. These settings may be changed before the run is constructed.
class Run {
 public:
  /// Prepares the model. A new run then creates and locks the folder and records the first state; a resumed
  /// run locks and reads the folder, and compares all recorded numbers with their checksums. If no run has
  /// begun in the folder of a resumed run, a new run begins. Throws std::invalid_argument (a bad scene),
  /// OutputRefused, RecordingMismatch (resuming with another scene, build, step, tolerance, method or frame
  /// rate, or a damaged recording), std::system_error, ChoiceStopped (`stop` returned true; no file has been
  /// written), Interrupted (`stop` returned true while recorded states were read). The scene must outlive the
  /// run.
  Run(Scene& scene, RunOptions options, Progress& progress);
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Steps to the end and writes trajectory.csv and, if the scene requests them, the tables of contacts.
  /// Returns false if `stop` ended the run; the last state is then recorded and the run can be resumed.
  /// Throws StepFailure (the last good state is then recorded), std::system_error.
  bool simulate();

  /// Performs a task after the simulation and records its wall time and files in run.json: write("meshes",
  /// {"meshes/frame_*.obj"}, task). If the task throws, the status becomes stopped (for Interrupted) or
  /// failed, and the exception continues.
  void write(const std::string& stage, const std::vector<std::string>& files,
             const std::function<void()>& task);

  /// Estimates the error of the run (pliant::estimate_error) and records it in run.json. Records the wall
  /// time as write() does.
  const ErrorEstimate& estimate_error();

  /// Writes the final status to run.json: complete, or stopped with a message.
  void finish(RunRecord::Status status, const std::string& message = "");

  const Scene& scene() const { return *scene_; }
  const Simulation& simulation() const { return *simulation_; }
  const FrameSchedule& schedule() const { return schedule_; }
  const std::filesystem::path& folder() const { return folder_->path(); }
  const RunRecord& record() const { return record_; }
  /// Opens the recording for reading, with the states recorded so far.
  Recording recording() const { return {folder_->path(), simulation_->model()}; }

 private:
  /// Writes the first state and the files of a new run into a new folder, and moves them into place together.
  void begin_recording(const StableStep& stable);
  void set_identity();
  void open_tables(std::int64_t states);
  void write_inputs(const std::filesystem::path& folder);
  void mend_inputs();
  /// Checks that the recorded run belongs to this scene and is not damaged, and sets the simulation to the
  /// last state that was recorded or saved.
  void resume_recording(const StableStep& stable);
  void check_resumable() const;
  void remove_lost_states();
  struct Continuation;
  Continuation find_continuation(const Recording& recorded);
  bool find_saved_state(const Recording& recorded, Continuation& from);
  void observe_recorded(const Recording& recorded, std::int64_t states);
  void set_options();
  void describe(const StableStep& stable);
  void note_setup(const StableStep& stable);
  void record_state();
  void note_recorded();
  void observe_state(const Ledger& ledger);
  Ledger checked_ledger();
  void record_last_valid_state();
  std::string end_failed(double elapsed);
  std::string remedy(double elapsed) const;
  void step_to_end();
  void flush(bool to_disk = false);
  void save(bool to_disk = false);
  /// Writes trajectory.csv and, if the scene requests them, the tables of contacts.
  void write_tables();
  void write_layout(const std::filesystem::path& folder);
  void add_whole_file(const std::filesystem::path& folder, const std::string& name);
  void save_checkpoint();
  void update_record();
  void count_work();
  void set_final_values();
  void write_record();
  void fail(const std::string& message) noexcept;
  /// Shows a note to the user, and adds it to run.json unless run.json has it.
  void note(const std::string& text);
  /// Calls note() unless run.json already has the note.
  void note_once(const std::string& text);
  void note_redundancy();
  void note_engagements();
  void note_turns();
  void note_ground();
  void note_slow_progress();
  void note_violations();
  void note_energy_balance();
  void note_uncontrolled_steps();
  void note_open_joints();
  void replace_notes(bool (*is_old)(const std::string&), const std::vector<std::string>& notes);

  Scene* scene_;
  RunOptions options_;
  Progress* progress_;
  std::unique_ptr<Simulation> simulation_;
  FrameSchedule schedule_;
  std::unique_ptr<RunFolder> folder_;
  std::unique_ptr<RecordingWriter> writer_;
  std::unique_ptr<ContactRecordingWriter> contacts_;  // nullptr unless the scene records contacts
  RunRecord record_;
  std::optional<EnergyMonitor> energies_;  // set by the constructor
  State last_recorded_;
  std::optional<TrackSampling> track_sampling_;  // set by the constructor
  double recorded_time_ = -1;                    // time of the last recorded state, s
  // Reported in notes so far: impulses of engaging joints, texts on redundant constraints, parts whose
  // surface rotates too far, overlapping pairs, and the acting joints at the last check of redundancy.
  std::size_t reported_impulses_ = 0;
  std::set<std::string> reported_redundant_, reported_turned_;
  std::set<TouchingPair> reported_overlaps_;
  std::vector<bool> reported_acting_;
  // At the state from which a resumed run continues: the counters of the whole run, and of the simulation.
  RunWork earlier_work_;
  std::optional<RunWork> work_at_start_;  // none in a new run
  std::size_t written_notes_ = 0;         // number of notes in run.json
  std::chrono::steady_clock::time_point started_, saved_, checkpointed_;
  bool stopped_ = false, reported_ground_ = false;
};

/// Returns the steps and frames of a scene.
FrameSchedule schedule_of(const Scene& scene);

/// Returns the number of threads that the parts of a scene can use, at most the number of threads of the
/// machine. Results do not depend on this number. Prepares the parts, and throws what Part::prepare() throws.
int automatic_threads(Scene& scene);

}  // namespace pliant
