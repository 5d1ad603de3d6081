#include <pliant/io/run/run.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include <pliant/io/run/checkpoint.h>
#include <pliant/io/run/contact_notes.h>
#include <pliant/io/run/energy_gate.h>
#include <pliant/io/run/joint_notes.h>
#include <pliant/io/run/remedy.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/run/scheduled_step.h>
#include <pliant/io/run/skipped.h>
#include <pliant/io/run/wall_clock.h>
#include <pliant/io/trajectory.h>

namespace pliant {
namespace {

constexpr std::chrono::milliseconds kFlushEvery{250};
constexpr std::size_t kFlushBytes = std::size_t{1} << 22;
/// The search for a remedy may take kRemedyShare times the wall time of the failed run, but at least
/// RunOptions::remedy_seconds, and at most kMaxRemedyShare times RunOptions::remedy_seconds.
constexpr double kRemedyShare = 3, kMaxRemedyShare = 10;

// Returns the simulation of a scene. Throws std::invalid_argument for inconsistent settings of the scene.
std::unique_ptr<Simulation> prepare(Scene& scene, const RunOptions& options) {
  if (scene.appearance.size() != scene.body.parts().size())
    throw std::invalid_argument("the scene has " + std::to_string(scene.body.parts().size()) +
                                " parts, but " + std::to_string(scene.appearance.size()) + " appearances");
  if (scene.obstacles.size() != scene.body.contact.obstacles.size())
    throw std::invalid_argument("the scene has " + std::to_string(scene.body.contact.obstacles.size()) +
                                " obstacles, but " + std::to_string(scene.obstacles.size()) +
                                " obstacle appearances");
  for (const Track& track : scene.tracks)
    if (track.point.part == nullptr) throw std::invalid_argument("track '" + track.name + "' has no part");
  return std::make_unique<Simulation>(scene.body, scene.integrator, options.threads, scene.tolerance,
                                      options.stop);
}

}  // namespace

int automatic_threads(Scene& scene) {
  // Dispatching work to the thread pool and waiting for it takes about 10 microseconds. A thread is therefore
  // used for every worth_a_thread microseconds of an evaluation.
  constexpr double worth_a_thread = 50;
  double cost = 0;
  for (const auto& part : scene.body.parts()) {
    if (part->fixed()) continue;
    scene.body.prepare(*part);
    cost += evaluation_cost(*part);
  }
  const int available = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::clamp(static_cast<int>(std::min(cost / worth_a_thread, 1024.0)), 1, available);
}

FrameSchedule schedule_of(const Scene& scene) {
  return scene.tolerance > 0 ? FrameSchedule::with_free_steps(scene.end, scene.frame_rate)
                             : FrameSchedule(scene.end, scene.step, scene.frame_rate);
}

Run::Run(Scene& scene, RunOptions options, Progress& progress)
    : scene_(&scene),
      options_(std::move(options)),
      progress_(&progress),
      schedule_(schedule_of(scene)),
      started_(WallClock::now()) {
  if (options_.threads <= 0) options_.threads = automatic_threads(scene);
  simulation_ = prepare(scene, options_);
  energies_.emplace(simulation_->model());
  track_sampling_.emplace(simulation_->model(), scene.tracks);
  const StableStep stable = stable_step(*simulation_);
  const std::string source = options_.scene_file == "-" ? "" : options_.scene_file;
  set_identity();
  set_options();
  folder_ = std::make_unique<RunFolder>(
      options_.folder, options_.existing, source,
      [this](const std::filesystem::path& file) { write_run_record(file, record_); });
  if (!folder_->note().empty()) note(folder_->note());
  if (options_.existing == Existing::resume && folder_->has_run())
    resume_recording(stable);
  else
    begin_recording(stable);
  checkpointed_ = WallClock::now();
}

Run::~Run() = default;

/// Sets the options of this session in the run record.
void Run::set_options() {
  const Scene& scene = *scene_;
  record_.status = RunRecord::Status::running;
  record_.message.clear();
  record_.command = options_.command;
  record_.scene = scene.name;
  record_.scene_file = options_.scene_file;
  record_.overrides = scene.overrides;
  record_.end = scene.end;
  record_.threads = options_.threads;
  if (!options_.graphics.empty()) record_.graphics = options_.graphics;
  record_.width = scene.width;
  record_.height = scene.height;
  record_.steps = schedule_.steps();
}

/// Sets the options of this session and the properties of the model in the run record, and adds notes on
/// them.
void Run::describe(const StableStep& stable) {
  set_options();
  record_.stable_step = stable.step;
  record_.joint_solver = solver_note(simulation_->model());
  record_.skipped = skipped_work(simulation_->model());
  record_.add_seconds("prepare", seconds_since(started_));
  note_setup(stable);
}

/// Returns the ledger of the present state. Throws NumericalFailure if its energies are not valid.
Ledger Run::checked_ledger() {
  const Ledger ledger = simulation_->ledger();
  const EnergyMonitor before = *energies_;
  energies_->add(ledger, simulation_->time());
  try {
    require_energy_balance(*simulation_, *energies_, last_recorded_);
  } catch (...) {
    energies_ = before;
    throw;
  }
  return ledger;
}

/// Records the last good state of a simulation that has failed, so that the motion before the failure can be
/// examined. A state with energies that are not valid is not recorded.
void Run::record_last_valid_state() {
  try {
    record_state();
  } catch (const NumericalFailure&) {
  }
}

/// Returns advice for a run that has failed after `elapsed` seconds of wall time.
std::string Run::remedy(double elapsed) const {
  const double seconds =
      std::clamp(kRemedyShare * elapsed, options_.remedy_seconds, kMaxRemedyShare * options_.remedy_seconds);
  return find_remedy(*scene_, {scene_->integrator, schedule_.step(), options_.threads}, seconds,
                     options_.stop);
}

void Run::record_state() {
  if (simulation_->time() == recorded_time_) return;
  const Ledger ledger = checked_ledger();
  note_recorded();
  count_work();
  writer_->append(simulation_->state(), record_.work);
  if (contacts_) contacts_->append(*simulation_);
  observe_state(ledger);
}

/// Stores the present state as the last recorded state.
void Run::note_recorded() {
  last_recorded_ = simulation_->state();
  recorded_time_ = simulation_->time();
  track_sampling_->note(last_recorded_);
}

/// Includes the present state of the simulation, which is recorded, in the largest and final values of
/// run.json, and adds notes on this state.
void Run::observe_state(const Ledger& ledger) {
  const Gaps gaps = widest_gaps(*simulation_);
  record_.max_gap = std::max(record_.max_gap, gaps.closed);
  record_.open_gap = gaps.open;
  const double depth = deepest_share(*simulation_);
  record_.max_depth = std::max(record_.max_depth, depth);
  if (depth > kReportedOverlap)
    for (const std::string& text : overlap_notes(*simulation_, reported_overlaps_)) note_once(text);
  note_redundancy();
  note_engagements();
  note_turns();
  note_ground();
  record_.max_energy = std::max(record_.max_energy, std::abs(ledger.energy()));
  record_.max_balance_error = energies_->max_error();
  record_.max_kinetic = energies_->max_kinetic();
  record_.movable_energy = energies_->movable();
  record_.energy_share = energies_->share();
}

/// Writes the contacts before the states, so that every recorded state has its contacts even if the process
/// is killed. Notes are written before the states that they are about, because notes on engaging joints
/// cannot be found again from states.
void Run::flush(bool to_disk) {
  if (record_.notes.size() != written_notes_) write_record();
  if (contacts_) contacts_->flush(to_disk);
  writer_->flush(to_disk);
}

void Run::write_tables() {
  write_trajectory(*folder_ / kTrajectoryFile, *scene_, *simulation_, recording());
  add_whole_file(folder_->path(), kTrajectoryFile);
  if (!contacts_) return;
  write_contact_tables(folder_->path(), simulation_->model());
  for (const char* file : {kContactsTable, kJointImpulsesTable}) add_whole_file(folder_->path(), file);
}

void Run::save(bool to_disk) {
  flush(to_disk);
  update_record();
  if (to_disk) record_.durable_states = record_.states;
  write_record();
}

/// Writes a checkpoint. All states recorded before it are then on the disk too.
void Run::save_checkpoint() {
  save(true);
  write_checkpoint(folder_->path(), {writer_->rows(), simulation_->state(), record_.work});
  checkpointed_ = WallClock::now();
}

/// Sets the progress, the counters and the checksums of the recorded states in the run record.
void Run::update_record() {
  record_.time = simulation_->time();
  record_.states = writer_->rows();
  for (const auto& [table, checksum] : writer_->checksums()) {
    record_.add_file(table);
    record_.set_checksum(table, checksum);
  }
  record_.add_file(kChecksumsFile);
  if (contacts_) {
    for (const auto& [table, checksum] : contacts_->checksums()) {
      record_.add_file(table);
      record_.set_checksum(table, checksum);
    }
    record_.add_file(kContactChecksumsFile);
  }
  count_work();
  set_final_values();
}

/// Sets the counters of all sessions in the run record. Before the first step of a resumed session, they are
/// the counters of the earlier sessions.
void Run::count_work() {
  const RunWork session{simulation_->step_counters(), simulation_->counters()};
  if (!work_at_start_)
    record_.work = session;
  else if (session.steps.steps == work_at_start_->steps.steps)
    record_.work = earlier_work_;
  else
    record_.work = continued(earlier_work_, session, *work_at_start_);
}

/// Sets the values of the present state in the run record.
void Run::set_final_values() {
  record_.steps_done = scene_->tolerance > 0 ? record_.work.steps.steps : simulation_->state().step;
  const std::vector<double>& rested = simulation_->state().at_rest;
  record_.asleep =
      static_cast<int>(std::count_if(rested.begin(), rested.end(), [](double time) { return time < 0; }));
  for (const std::string& name : simulation_->velocities_without_inertia())
    if (std::find(record_.velocities_without_inertia.begin(), record_.velocities_without_inertia.end(),
                  name) == record_.velocities_without_inertia.end())
      record_.velocities_without_inertia.push_back(name);
}

void Run::write_record() {
  write_run_record(*folder_ / kRunFile, record_);
  written_notes_ = record_.notes.size();
  saved_ = WallClock::now();
}

void Run::step_to_end() {
  if (at_end(*simulation_, schedule_)) return;
  WallClock::time_point flushed = WallClock::now();
  const double first_time = simulation_->time();
  progress_->begin("simulate", schedule_.end() - first_time, "s");
  while (!at_end(*simulation_, schedule_)) {
    if (options_.stop && options_.stop()) {
      stopped_ = true;
      break;
    }
    const bool records =
        scheduled_step(*simulation_, schedule_) || track_sampling_->has_moved(simulation_->state());
    note_slow_progress();
    progress_->advance(simulation_->time() - first_time);
    if (records) record_state();
    const WallClock::time_point now = WallClock::now();
    if (seconds_since(checkpointed_) >= options_.checkpoint_every && !at_end(*simulation_, schedule_)) {
      save_checkpoint();
      continue;
    }
    if (!records) continue;
    const std::size_t pending = writer_->pending_bytes() + (contacts_ ? contacts_->pending_bytes() : 0);
    if (now - flushed < kFlushEvery && pending < kFlushBytes) continue;
    flush();
    flushed = now;
    if (now - saved_ > 8 * kFlushEvery) save();
  }
  if (stopped_) record_state();
  progress_->end();
}

/// Writes the recording and the tables of a run that has failed after `elapsed` seconds of wall time. Returns
/// a text about an error while writing, which does not replace the failure; empty if there is none.
std::string Run::end_failed(double elapsed) {
  try {
    record_last_valid_state();
    record_.add_seconds("simulate", elapsed);
    save(true);
    note_violations();
    write_tables();
    return {};
  } catch (const std::exception& error) {
    return std::string("; the files of the run are not complete: ") + error.what();
  }
}

bool Run::simulate() {
  const WallClock::time_point start = WallClock::now();
  try {
    try {
      step_to_end();
    } catch (const NumericalFailure& failure) {
      const std::string incomplete = end_failed(seconds_since(start));
      throw NumericalFailure(failure.what() + ("; " + remedy(seconds_since(start))) + incomplete,
                             failure.time);
    } catch (const StepFailure&) {
      end_failed(seconds_since(start));
      throw;
    }
    record_.add_seconds("simulate", seconds_since(start));
    save(true);
    if (!stopped_) remove_checkpoints(folder_->path());
    note_uncontrolled_steps();
    note_violations();
    note_energy_balance();
    note_open_joints();
    write("trajectory", {}, [&] { write_tables(); });
  } catch (const std::exception& failure) {
    fail(failure.what());
    throw;
  }
  return !stopped_;
}

void Run::write(const std::string& stage, const std::vector<std::string>& files,
                const std::function<void()>& task) {
  const WallClock::time_point start = WallClock::now();
  try {
    task();
  } catch (const Interrupted& interruption) {
    finish(RunRecord::Status::stopped, stage + ": " + interruption.what());
    throw;
  } catch (const std::exception& failure) {
    fail(stage + ": " + failure.what());
    throw;
  }
  record_.add_seconds(stage, seconds_since(start));
  for (const std::string& file : files) record_.add_file(file);
  save();
}

const ErrorEstimate& Run::estimate_error() {
  write("estimate error", {}, [&] {
    record_.error = pliant::estimate_error(*scene_, simulation_->integrator().name(), schedule_.step(),
                                           recording(), options_.threads, *progress_);
  });
  return *record_.error;
}

void Run::finish(RunRecord::Status status, const std::string& message) {
  record_.status = status;
  record_.message = message;
  save(true);
}

void Run::fail(const std::string& message) noexcept {
  try {
    record_.status = RunRecord::Status::failed;
    record_.message = message;
    count_work();
    set_final_values();
    write_record();  // not save(), which flushes the recording: the flush may have failed
  } catch (const std::exception&) {
    // Only the first failure is reported.
  }
}

}  // namespace pliant
