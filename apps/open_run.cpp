// Reads the record (run.json), the scene and the recording (tables of states) of a run, and checks that they
// belong together.
#include "open_run.h"

#include <pliant/io/format/number_text.h>
#include <pliant/io/frame_schedule.h>
#include <pliant/io/layout.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/run/run_folder.h>
#include <pliant/scene/read_scene.h>

#include "scene_options.h"

namespace pliant_cli {

namespace {

// Returns the command that continues a run.
std::string resume_command(const pliant::RunRecord& record, const std::filesystem::path& folder) {
  return "pliant run " + (record.scene_file.empty() ? "SCENE" : record.scene_file) + " -o " +
         folder.string() + " --resume";
}

}  // namespace

OpenRun open_run(const std::filesystem::path& folder) {
  OpenRun run;
  run.record = pliant::read_run_record(folder / pliant::kRunFile);
  const std::filesystem::path file = folder / pliant::kSceneFile;
  if (!std::filesystem::exists(file))
    throw pliant::RecordingMismatch("cannot open the run in " + folder.string() + ": its scene " +
                                    file.string() + " is missing");
  pliant::Diagnostics warnings;  // ignored: they were shown at the start of the run
  run.scene = pliant::read_scene(file.string(), run.record.overrides, warnings, solvers(),
                                 pliant::MeshFiles::of_a_run);
  if (run.scene->hash != run.record.scene_hash)
    throw pliant::RecordingMismatch("the scene " + file.string() +
                                    " was changed after the run was recorded; restore it or simulate again");
  run.scene->name = run.record.scene;
  run.scene->frame_rate = run.record.frame_rate;
  run.scene->width = run.record.width;
  run.scene->height = run.record.height;
  run.model = std::make_unique<pliant::Model>(run.scene->body);
  // Not in the `try` below, because a run with another version or scene cannot be continued.
  pliant::compare_layout(folder, *run.model);
  try {
    run.recording = std::make_unique<pliant::Recording>(folder, *run.model);
  } catch (const pliant::RecordingMismatch& fault) {
    if (run.record.status != pliant::RunRecord::Status::running) throw;
    throw pliant::RecordingMismatch(std::string(fault.what()) + "; the run did not end; continue with: " +
                                    resume_command(run.record, folder));
  }
  // A run that was killed may have lost states that were not yet on the disk. A run that has ended cannot
  // have lost states.
  if (run.record.status != pliant::RunRecord::Status::running && run.recording->rows() < run.record.states)
    throw pliant::RecordingMismatch(
        "the recording in " + folder.string() + " is damaged: its tables contain " +
        pliant::count_text(run.recording->rows(), "whole state") + ", but the run recorded " +
        std::to_string(run.record.states) +
        "; simulate the missing ones again with: " + resume_command(run.record, folder));
  if (run.recording->rows() == 0)
    throw pliant::RecordingMismatch("the recording in " + folder.string() + " has no state; simulate again");
  return run;
}

std::int64_t OpenRun::frames() const {
  const double reached = recording->time(recording->rows() - 1);
  const pliant::FrameSchedule schedule =
      record.tolerance > 0 ? pliant::FrameSchedule::with_free_steps(reached, record.frame_rate)
                           : pliant::FrameSchedule::with_exact_step(reached, record.step, record.frame_rate);
  return schedule.frames(reached);
}

void prepare_frame_folder(const std::filesystem::path& folder, const std::vector<std::int64_t>& frames,
                          const std::string& ending, bool force) {
  if (folder.has_parent_path()) std::filesystem::create_directories(folder.parent_path());
  pliant::make_subfolder(folder);
  if (force) return;
  for (const std::int64_t frame : frames) {
    const std::filesystem::path file = folder / pliant::frame_name("frame", frame, ending);
    if (std::filesystem::exists(file))
      throw pliant::OutputRefused(file.string() +
                                  " exists; use --force to replace it, or -o for another folder");
  }
}

}  // namespace pliant_cli
