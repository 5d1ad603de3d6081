// The beginning of a new run or of a resumed run.
#include <algorithm>
#include <cmath>
#include <utility>

#include <pliant/io/format/number_text.h>
#include <pliant/io/format/ply.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/layout.h>
#include <pliant/io/run/checkpoint.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/trajectory.h>
#include <pliant/scene/mesh_file.h>

namespace pliant {
namespace {

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

}  // namespace

/// Sets the properties of the run record that a resumed run must have too.
void Run::set_identity() {
  record_.build = build_info();
  record_.scene_hash = scene_->hash;
  record_.requested_step = scene_->tolerance > 0 ? 0 : scene_->step;
  record_.tolerance = scene_->tolerance;
  record_.step = schedule_.step();
  record_.frame_rate = scene_->frame_rate;
  record_.integrator = simulation_->integrator().name();
  record_.requested_integrator = scene_->integrator;
}

/// Adds a finished file and its checksum to the run record.
void Run::add_whole_file(const std::filesystem::path& folder, const std::string& name) {
  record_.add_file(name);
  record_.set_checksum(name, crc32_of_file(folder / name));
}

/// Writes the scene and the meshes of its obstacles.
void Run::write_inputs(const std::filesystem::path& folder) {
  if (!scene_->document.empty()) {
    write_whole_file(folder / kSceneFile, scene_->document.data(), scene_->document.size(), Durable::yes);
    add_whole_file(folder, kSceneFile);
  }
  for (std::size_t i = 0; i < scene_->obstacles.size(); ++i) {
    const MeshFile& mesh = scene_->obstacles[i].mesh;
    if (mesh.triangles.cols() == 0) continue;
    const std::string& name = scene_->body.contact.obstacles[i].name;
    const std::string file = recorded_mesh_name(name);
    write_ply(folder / file, {{name, scene_->obstacles[i].color, node_mesh(mesh.triangles, mesh.vertices)}});
    add_whole_file(folder, file);
  }
}

/// Writes the scene and the meshes of its obstacles again if one of their files is missing or has changed.
/// The scene of this session has the same hash as the scene of the recorded run.
void Run::mend_inputs() {
  for (const auto& [file, checksum] : record_.checksums) {
    if (file != kSceneFile && !is_recorded_mesh(file)) continue;
    const std::filesystem::path path = *folder_ / file.c_str();
    if (std::filesystem::exists(path) && crc32_of_file(path) == checksum) continue;
    note(path.string() + " was damaged or changed; it is written again");
    write_inputs(folder_->path());
    return;
  }
}

void Run::write_layout(const std::filesystem::path& folder) {
  const TrajectoryTable trajectory(*scene_, *simulation_);
  pliant::write_layout(folder, simulation_->model(), schedule_, trajectory.columns(), scene_->contacts);
  add_whole_file(folder, kLayoutFile);
}

/// Opens the tables of the folder, and removes the rows after the first `states` recorded states.
void Run::open_tables(std::int64_t states) {
  const std::filesystem::path& folder = folder_->path();
  writer_ = std::make_unique<RecordingWriter>(RecordingWriter::resume(folder, simulation_->model(), states));
  if (scene_->contacts)
    contacts_ = std::make_unique<ContactRecordingWriter>(ContactRecordingWriter::resume(folder, states));
}

void Run::begin_recording(const StableStep& stable) {
  if (schedule_.step() != record_.requested_step) {
    note("the end " + number_text(scene_->end) + " s is not a multiple of the step " +
         number_text(scene_->step) + " s; the run uses steps of " + number_text(schedule_.step()) + " s");
  }
  describe(stable);
  const std::filesystem::path place = folder_->new_run();
  record_.add_file(kRunFile);
  write_inputs(place);
  write_layout(place);
  const Model& model = simulation_->model();
  writer_ = std::make_unique<RecordingWriter>(
      RecordingWriter::create(place, model, simulation_->clusters() != nullptr));
  if (scene_->contacts)
    contacts_ = std::make_unique<ContactRecordingWriter>(ContactRecordingWriter::create(place));
  record_state();
  written_notes_ = record_.notes.size();  // run.json, with all notes, is written below
  flush(true);
  update_record();
  record_.durable_states = record_.states;
  write_run_record(place / kRunFile, record_);
  folder_->begin_new_run();
  open_tables(writer_->rows());  // at their new paths
  saved_ = std::chrono::steady_clock::now();
}

/// Throws RecordingMismatch if build, scene or settings differ from the recorded run.
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

/// Compares the recorded numbers with their checksums. After a power cut, the last states may have lost
/// numbers that were not yet on the disk; these states are removed, with a note. Throws RecordingMismatch,
/// naming the files, if numbers of earlier states are damaged.
void Run::remove_lost_states() {
  Inspection found = state_checksums(folder_->path(), simulation_->model()).inspect();
  if (scene_->contacts) {
    Inspection contacts = contact_checksums(folder_->path()).inspect();
    found.undamaged = std::min(found.undamaged, contacts.undamaged);
    found.damage.insert(found.damage.end(), contacts.damage.begin(), contacts.damage.end());
  }
  if (found.damage.empty()) return;
  std::string texts;
  for (const std::string& text : found.damage) texts += (texts.empty() ? "" : "; ") + text;
  if (found.undamaged < record_.durable_states)
    throw RecordingMismatch("cannot resume this run: " + texts +
                            ". Restore the damaged file, or simulate again with --force");
  note(
      "the last recorded states were not yet on the disk when the run was interrupted, and are simulated "
      "again: " +
      texts);
  open_tables(found.undamaged);
  writer_.reset();
  contacts_.reset();
}

/// The state from which a resumed run continues.
struct Run::Continuation {
  std::int64_t keep = 0;       ///< number of recorded states that an uninterrupted run would record
  std::optional<State> state;  ///< without a value: the initial state
  RunWork work;                ///< of the run up to this state
};

/// Sets a continuation to a checkpoint that is later than the first from.keep recorded states. Returns false
/// if there is no such checkpoint.
bool Run::find_saved_state(const Recording& recorded, Continuation& from) {
  FoundCheckpoint found = find_checkpoint(folder_->path(), simulation_->model(), from.keep, schedule_.end());
  if (!found.damage.empty()) note(found.damage + "; the run continues from an earlier state");
  if (!found.checkpoint || !(found.checkpoint->state.time() > recorded.time(from.keep - 1))) return false;
  from.state = std::move(found.checkpoint->state);
  from.work = found.checkpoint->work;
  return true;
}

/// Returns the last recorded state that an uninterrupted run would reach, or a later checkpoint.
Run::Continuation Run::find_continuation(const Recording& recorded) {
  Continuation from;
  from.keep = recorded.rows();
  if (scene_->contacts) from.keep = std::min(from.keep, contact_checksums(folder_->path()).whole_states());
  // With error control, the last step may have been shortened by the end of the run. If the new end is later,
  // this step is removed and repeated.
  if (scene_->tolerance > 0 && from.keep > 1 && recorded.time(from.keep - 1) >= record_.end &&
      scene_->end > record_.end)
    --from.keep;
  if (from.keep == 0 || find_saved_state(recorded, from)) return from;
  State last = recorded.state(from.keep - 1);
  from.work = recorded.work(from.keep - 1);
  if (last.time() > schedule_.end() * (1 + 1e-9))
    throw RecordingMismatch("cannot resume this run: it has reached t = " + number_text(last.time()) +
                            " s, beyond the requested end of " + number_text(scene_->end) + " s");
  // An uninterrupted run does not record a state that was recorded only because the run ended there.
  bool in_unbroken =
      scene_->tolerance > 0
          ? schedule_.records(from.keep > 1 ? recorded.time(from.keep - 2) : 0, last.time(), last.h)
          : schedule_.records(last.step);
  if (!in_unbroken && from.keep > 1) {
    track_sampling_->note(recorded.state(from.keep - 2));
    in_unbroken = track_sampling_->has_moved(last);
  }
  if (!in_unbroken) --from.keep;
  from.state = std::move(last);
  return from;
}

/// Includes the first `states` recorded states in the largest values and the notes of the run record, as the
/// session that recorded these states did. Notes that run.json already has are not repeated. Throws
/// Interrupted if `stop` of the options returns true; the run can then be resumed again.
void Run::observe_recorded(const Recording& recorded, std::int64_t states) {
  record_.max_gap = record_.max_depth = record_.max_energy = 0;
  progress_->begin("read", static_cast<double>(states), "states");
  for (std::int64_t row = 0; row < states; ++row) {
    simulation_->set_state(recorded.state(row));
    note_recorded();
    const Ledger ledger = simulation_->ledger();
    energies_->add(ledger, recorded_time_);
    observe_state(ledger);
    progress_->advance(static_cast<double>(row + 1));
    if (options_.stop && options_.stop())
      throw Interrupted("stopped while the recorded states were read; continue with --resume");
  }
  progress_->end();
}

void Run::resume_recording(const StableStep& stable) {
  record_ = read_run_record(*folder_ / kRunFile);
  check_resumable();
  if (scene_->tolerance == 0)
    schedule_ = FrameSchedule::with_exact_step(scene_->end, record_.step, record_.frame_rate);
  if (std::abs(schedule_.end() - scene_->end) > 1e-9 * scene_->end) {
    note("the end " + number_text(scene_->end) + " s is not a multiple of the step " +
         number_text(record_.step) + " s of this run; the run ends at " + number_text(schedule_.end()) +
         " s");
  }
  mend_inputs();
  write_layout(folder_->path());
  remove_lost_states();
  const Recording recorded = recording();
  Continuation from = find_continuation(recorded);
  observe_recorded(recorded, from.keep);
  open_tables(from.keep);
  if (from.state) {
    simulation_->set_state(std::move(*from.state));
    earlier_work_ = from.work;
    earlier_work_.steps.factorisations = record_.work.steps.factorisations;
    work_at_start_ = RunWork{simulation_->step_counters(), simulation_->counters()};
  }
  if (from.keep == 0 && simulation_->time() == 0) record_state();
  ++record_.resumed;
  describe(stable);
  save(true);
}

}  // namespace pliant
