#include <pliant/io/run/run.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include <pliant/contact/longest_contact_step.h>
#include <pliant/io/format/number_text.h>
#include <pliant/io/format/ply.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/run/contact_notes.h>
#include <pliant/io/run/joint_notes.h>
#include <pliant/io/run/order_note.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/run/skipped.h>
#include <pliant/io/trajectory.h>
#include <pliant/part/mesh/surface_turn.h>

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kFlushEvery{250};
constexpr std::size_t kFlushBytes = std::size_t{1} << 22;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Throws RecordingMismatch if a setting of a resumed run has changed. hint: appended to the message.
template <class Value>
void require_same(const char* name, const Value& recorded, const Value& now, const std::string& hint = "") {
  if (recorded == now) return;
  std::string message = std::string("cannot resume this run: ") + name + " was ";
  if constexpr (std::is_arithmetic_v<Value>)
    message += number_text(recorded) + " and is now " + number_text(now);
  else
    message += recorded + " and is now " + now;
  throw RecordingMismatch(message + hint);
}

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
    part->prepare();
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
    : scene_(&scene), options_(std::move(options)), progress_(&progress), schedule_(schedule_of(scene)) {
  const Clock::time_point start = Clock::now();
  if (options_.threads <= 0) options_.threads = automatic_threads(scene);
  simulation_ = prepare(scene, options_);
  const StableStep stable = stable_step(*simulation_);
  const std::string source = options_.scene_file == "-" ? "" : options_.scene_file;
  folder_ = std::make_unique<RunFolder>(options_.folder, options_.existing, source);
  if (options_.existing == Existing::resume)
    resume_recording();
  else
    begin_recording();
  describe(stable);
  record_.add_seconds("prepare", seconds_since(start));
  note_setup(stable);
  write_layout(folder_->path(), simulation_->model(), schedule_,
               TrajectoryTable(scene, *simulation_).columns(), scene.contacts);
  list_files();
  save(true);
}

Run::~Run() = default;

/// Sets the options of this session in the run record.
void Run::describe(const StableStep& stable) {
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
  record_.stable_step = stable.step;
  record_.joint_solver = solver_note(simulation_->model());
  record_.skipped = skipped_work(simulation_->model());
}

/// Adds notes on a step that is too large, on the chosen integrator, on the assembly and on redundant
/// constraints.
void Run::note_setup(const StableStep& stable) {
  if (scene_->tolerance == 0 && schedule_.step() > stable.step) {
    note("warning: the step of " + number_text(schedule_.step()) +
         " s is larger than the largest stable step, about " + rounded_text(stable.step) + " s, limited by " +
         stable.limit + "; choose a smaller step");
  }
  if (scene_->tolerance == 0 && !stable.uncounted.empty())
    note("the largest stable step is not certain: " + stable.uncounted);
  if (!simulation_->choice().integrator.empty())
    note("integrator " + simulation_->choice().integrator + ": " + simulation_->choice().why);
  const AssemblyReport& assembly = simulation_->assembly();
  if (assembly.iterations > 0)
    note("assembled before time 0: gaps of up to " + rounded_text(assembly.gap_before) + " m closed in " +
         count_text(assembly.iterations, "iteration") +
         (assembly.converged ? "" : ", the maximum; the shapes have not converged"));
  note_redundancy();
}

/// Adds to the run record the names of the files that are written during the run.
void Run::list_files() {
  for (const char* file :
       {kRunFile, kSceneFile, kLayoutFile, kTimesFile, kCoordinatesFile, kVelocitiesFile, kModesFile})
    if (file != kSceneFile || !scene_->document.empty()) record_.add_file(file);
  if (simulation_->model().body().contact.active) record_.add_file(kContactCacheFile);
  if (scene_->contacts)
    for (const char* file : {kContactsFile, kJointImpulsesFile}) record_.add_file(file);
}

void Run::begin_recording() {
  record_.build = build_info();
  record_.scene_hash = scene_->hash;
  record_.requested_step = scene_->tolerance > 0 ? 0 : scene_->step;
  record_.tolerance = scene_->tolerance;
  record_.step = schedule_.step();
  record_.frame_rate = scene_->frame_rate;
  record_.integrator = simulation_->integrator().name();
  record_.requested_integrator = scene_->integrator;
  if (schedule_.step() != record_.requested_step) {
    note("the end " + number_text(scene_->end) + " s is not a multiple of the step " +
         number_text(scene_->step) + " s; the run uses steps of " + number_text(schedule_.step()) + " s");
  }
  write_run_record(*folder_ / kRunFile, record_);  // run.json marks the folder as the folder of a run
  if (!scene_->document.empty())
    write_whole_file(*folder_ / kSceneFile, scene_->document.data(), scene_->document.size(), Durable::yes);
  for (std::size_t i = 0; i < scene_->obstacles.size(); ++i) {
    const MeshFile& mesh = scene_->obstacles[i].mesh;
    if (mesh.triangles.cols() == 0) continue;
    const std::string& name = scene_->body.contact.obstacles[i].name;
    const std::string file = recorded_mesh_name(name);
    write_ply(folder_->path() / file,
              {{name, scene_->obstacles[i].color, node_mesh(mesh.triangles, mesh.vertices)}});
    record_.add_file(file);
  }
  writer_ = std::make_unique<RecordingWriter>(
      RecordingWriter::create(folder_->path(), simulation_->model(), simulation_->clusters() != nullptr));
  if (scene_->contacts)
    contacts_ = std::make_unique<ContactRecordingWriter>(ContactRecordingWriter::create(folder_->path()));
  record_state();
  flush();
}

/// Throws RecordingMismatch if build, scene or settings differ from those of the recorded run.
void Run::check_resumable() const {
  for (const auto& [name, value] : build_info()) {
    const auto recorded = std::find_if(record_.build.begin(), record_.build.end(),
                                       [&key = name](const auto& entry) { return entry.first == key; });
    require_same(("its program's " + name).c_str(),
                 recorded == record_.build.end() ? "unknown" : recorded->second, value,
                 "; only the build that began the run reproduces its numbers");
  }
  if (record_.scene_hash != scene_->hash)
    throw RecordingMismatch("cannot resume this run: the scene, its meshes or its --set values have changed");
  require_same("the integrator", record_.requested_integrator, scene_->integrator);
  require_same("the frame rate", record_.frame_rate, scene_->frame_rate);
  require_same("the tolerance", record_.tolerance, scene_->tolerance);
  if (scene_->tolerance == 0) require_same("the step", record_.requested_step, scene_->step);
}

/// Sets the simulation to the last recorded state that an uninterrupted run would reach. keep: on call, the
/// number of recorded states; on return, the number of these that an uninterrupted run would record.
void Run::set_last_state(const Recording& recorded, std::int64_t& keep) {
  // With error control, the last step may have been shortened by the end of the run. If the new end is later,
  // this step is removed and repeated.
  if (scene_->tolerance > 0 && keep > 1 && recorded.time(keep - 1) >= record_.end &&
      scene_->end > record_.end)
    --keep;
  if (keep == 0) return;
  State last = recorded.state(keep - 1);
  if (last.time() > schedule_.end() * (1 + 1e-9))
    throw RecordingMismatch("cannot resume this run: it has reached t = " + number_text(last.time()) +
                            " s, beyond the requested end of " + number_text(scene_->end) + " s");
  // An uninterrupted run does not record a state that was recorded only because the run ended there.
  const bool in_unbroken =
      scene_->tolerance > 0 ? schedule_.records(keep > 1 ? recorded.time(keep - 2) : 0, last.time(), last.h)
                            : schedule_.records(last.step);
  if (in_unbroken)
    recorded_time_ = last.time();
  else
    --keep;
  simulation_->set_state(std::move(last));
}

void Run::resume_recording() {
  record_ = read_run_record(*folder_ / kRunFile);
  check_resumable();
  if (scene_->tolerance == 0)
    schedule_ = FrameSchedule::with_exact_step(scene_->end, record_.step, record_.frame_rate);
  if (std::abs(schedule_.end() - scene_->end) > 1e-9 * scene_->end) {
    note("the end " + number_text(scene_->end) + " s is not a multiple of the step " +
         number_text(record_.step) + " s of this run; the run ends at " + number_text(schedule_.end()) +
         " s");
  }
  const Recording recorded = recording();
  std::int64_t keep = recorded.rows();
  set_last_state(recorded, keep);
  writer_ =
      std::make_unique<RecordingWriter>(RecordingWriter::resume(folder_->path(), simulation_->model(), keep));
  if (scene_->contacts)
    contacts_ = std::make_unique<ContactRecordingWriter>(
        ContactRecordingWriter::resume(folder_->path(), keep > 0 ? recorded.time(keep - 1) : -1));
  if (keep == 0 && simulation_->time() == 0) record_state();
  earlier_steps_ = record_.step_counters;
  earlier_counters_ = record_.counters;
  ++record_.resumed;
}

void Run::note(const std::string& text) {
  if (std::find(record_.notes.begin(), record_.notes.end(), text) == record_.notes.end())
    record_.notes.push_back(text);
  progress_->note(text);
}

/// Adds notes on redundant constraints, if the set of acting joints has changed since the last call; each
/// text at most once.
void Run::note_redundancy() {
  std::vector<bool> acting;
  for (const JointMode mode : simulation_->state().joints) acting.push_back(mode != JointMode::off);
  if (acting == reported_acting_) return;
  reported_acting_ = std::move(acting);
  for (const std::string& text : redundancy_notes(*simulation_))
    if (reported_redundant_.insert(text).second) note(text);
}

void Run::note_engagements() {
  for (const std::string& text : engage_notes(*simulation_, reported_impulses_)) note(text);
  reported_impulses_ = simulation_->engage_impulses().size();
}

/// Adds a note, once per part, if the parameters of the part rotate its surface so far that elasticity linear
/// in d is no longer accurate.
void Run::note_turns() {
  for (const PartModel& m : simulation_->model().parts()) {
    if (m.q0 < 0 || !linear_on_moving_shape(*m.part) || reported_turned_.count(m.part->name()) > 0) continue;
    const double turn = largest_surface_turn(*m.part, simulation_->state().q.segment(m.q0 + 7, m.n_s));
    if (!(turn > kMaxLinearRotation)) continue;
    reported_turned_.insert(m.part->name());
    note("warning: at t = " + rounded_text(simulation_->time()) + " s the parameters of part '" +
         m.part->name() + "' rotate some of its surface by " + rounded_text(turn) +
         " rad; a local law that is linear in the displacements is accurate up to about " +
         rounded_text(kMaxLinearRotation) +
         " rad; use a law that is valid for all rotations (neo_hookean, st_venant_kirchhoff, corotated, "
         "neo_hookean_membrane, st_venant_kirchhoff_membrane)");
  }
}

/// Adds notes on violations of the laws of contact. They replace those of earlier sessions of a resumed run.
/// write_record() must have updated the counters.
void Run::note_violations() {
  std::vector<std::string>& notes = record_.notes;
  notes.erase(std::remove_if(notes.begin(), notes.end(), is_violation_note), notes.end());
  for (const std::string& text : violation_notes(record_.step_counters, scene_->body.contact)) note(text);
}

void Run::record_state() {
  if (simulation_->time() == recorded_time_) return;
  recorded_time_ = simulation_->time();
  writer_->append(simulation_->state());
  if (contacts_) contacts_->append(*simulation_);
  const Ledger ledger = simulation_->ledger();
  const Gaps gaps = widest_gaps(*simulation_);
  record_.max_gap = std::max(record_.max_gap, gaps.closed);
  record_.open_gap = gaps.open;
  const double depth = deepest_share(*simulation_);
  record_.max_depth = std::max(record_.max_depth, depth);
  if (depth > kReportedOverlap)
    for (const std::string& text : overlap_notes(*simulation_, reported_overlaps_)) note(text);
  note_redundancy();
  note_engagements();
  note_turns();
  record_.max_balance_error = std::max(record_.max_balance_error, std::abs(ledger.balance));
  record_.max_energy = std::max(record_.max_energy, std::abs(ledger.energy()));
  record_.max_kinetic = std::max(record_.max_kinetic, ledger.kinetic);
}

/// Writes the contacts first, so that every recorded state has its contacts even if the process is killed.
void Run::flush(bool to_disk) {
  if (contacts_) contacts_->flush(to_disk);
  writer_->flush(to_disk);
}

void Run::write_tables() {
  write_trajectory(*folder_ / kTrajectoryFile, *scene_, *simulation_, recording());
  record_.add_file(kTrajectoryFile);
  if (!contacts_) return;
  write_contact_tables(folder_->path(), simulation_->model());
  for (const char* file : {kContactsTable, kJointImpulsesTable}) record_.add_file(file);
}

void Run::save(bool to_disk) {
  flush(to_disk);
  record_.time = simulation_->time();
  record_.states = writer_->rows();
  write_record();
}

void Run::write_record() {
  const StepCounters& session = simulation_->step_counters();
  record_.step_counters.steps = earlier_steps_.steps + session.steps;
  record_.steps_done = scene_->tolerance > 0 ? record_.step_counters.steps : simulation_->state().step;
  record_.step_counters.evaluations = earlier_steps_.evaluations + session.evaluations;
  record_.step_counters.rejected = earlier_steps_.rejected + session.rejected;
  record_.step_counters.uncontrolled = earlier_steps_.uncontrolled + session.uncontrolled;
  record_.step_counters.limit_impulses = earlier_steps_.limit_impulses + session.limit_impulses;
  record_.step_counters.factorisations = earlier_steps_.factorisations + session.factorisations;
  record_.step_counters.impacts = earlier_steps_.impacts + session.impacts;
  record_.step_counters.sequential_impacts = earlier_steps_.sequential_impacts + session.sequential_impacts;
  record_.step_counters.contact_sweeps = earlier_steps_.contact_sweeps + session.contact_sweeps;
  record_.step_counters.contact_fallbacks = earlier_steps_.contact_fallbacks + session.contact_fallbacks;
  record_.step_counters.contact_cutoffs = earlier_steps_.contact_cutoffs + session.contact_cutoffs;
  record_.step_counters.contact_residual =
      std::max(earlier_steps_.contact_residual, session.contact_residual);
  record_.step_counters.contact_overlap = std::max(earlier_steps_.contact_overlap, session.contact_overlap);
  record_.step_counters.worst_residual = earlier_steps_.worst_residual;
  record_.step_counters.worst_residual.keep_worse(session.worst_residual);
  record_.step_counters.worst_overlap = earlier_steps_.worst_overlap;
  record_.step_counters.worst_overlap.keep_worse(session.worst_overlap);
  record_.counters = earlier_counters_;
  record_.counters += simulation_->counters();
  const std::vector<double>& rested = simulation_->state().at_rest;
  record_.asleep =
      static_cast<int>(std::count_if(rested.begin(), rested.end(), [](double time) { return time < 0; }));
  for (const std::string& name : simulation_->velocities_without_inertia())
    if (std::find(record_.velocities_without_inertia.begin(), record_.velocities_without_inertia.end(),
                  name) == record_.velocities_without_inertia.end())
      record_.velocities_without_inertia.push_back(name);
  write_run_record(*folder_ / kRunFile, record_);
  saved_ = Clock::now();
}

bool Run::at_end() const {
  return scene_->tolerance > 0 ? simulation_->time() >= schedule_.end()
                               : simulation_->state().step >= schedule_.steps();
}

/// Performs one step. Returns whether the new state is to be recorded.
bool Run::step_once() {
  if (scene_->tolerance == 0) {
    simulation_->step(schedule_.step());
    return schedule_.records(simulation_->state().step);
  }
  const double before = simulation_->time();
  simulation_->step_up_to(schedule_.end());
  return schedule_.records(before, simulation_->time(), simulation_->state().h);
}

void Run::step_to_end() {
  if (at_end()) return;
  Clock::time_point flushed = Clock::now();
  const double first_time = simulation_->time();
  progress_->begin("simulate", schedule_.end() - first_time, "s");
  while (!at_end()) {
    if (options_.stop && options_.stop()) {
      stopped_ = true;
      break;
    }
    const bool records = step_once();
    progress_->advance(simulation_->time() - first_time);
    if (!records) continue;
    record_state();
    const Clock::time_point now = Clock::now();
    const std::size_t pending = writer_->pending_bytes() + (contacts_ ? contacts_->pending_bytes() : 0);
    if (now - flushed < kFlushEvery && pending < kFlushBytes) continue;
    flush();
    flushed = now;
    if (now - saved_ > 8 * kFlushEvery) save();
  }
  if (stopped_) record_state();
  progress_->end();
}

bool Run::simulate() {
  const Clock::time_point start = Clock::now();
  try {
    try {
      step_to_end();
    } catch (const StepFailure&) {
      // The simulation is at the last good state. It is recorded, so that the motion before the failure can
      // be examined.
      record_state();
      record_.add_seconds("simulate", seconds_since(start));
      save(true);
      note_violations();
      write_tables();
      throw;
    }
    record_.add_seconds("simulate", seconds_since(start));
    save(true);
    if (record_.step_counters.uncontrolled > 0)
      note("resting contacts of many bodies, or of soft ones, in " +
           count_text(record_.step_counters.uncontrolled, "step") +
           ": the error of these steps is not controlled; they are at most " +
           rounded_text(longest_contact_step(scene_->body.contact, simulation_->tolerance())) +
           " s long, and --estimate-error measures their error");
    note_violations();
    for (const std::string& text :
         {open_joints_note(*simulation_), order_note(record_, simulation_->integrator().order())})
      if (!text.empty()) note(text);
    write("trajectory", {}, [&] { write_tables(); });
  } catch (const std::exception& failure) {
    fail(failure.what());
    throw;
  }
  return !stopped_;
}

void Run::write(const std::string& stage, const std::vector<std::string>& files,
                const std::function<void()>& task) {
  const Clock::time_point start = Clock::now();
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
    write_record();  // not save(), which flushes the recording: flushing may be what failed
  } catch (const std::exception&) {
    // The first failure is the one that is reported.
  }
}

}  // namespace pliant
