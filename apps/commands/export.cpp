// pliant export: writes the meshes of a recorded run.
#include <map>
#include <memory>

#include <pliant/io/mesh_frames.h>
#include <pliant/io/run/run_files.h>

#include "color_options.h"
#include "command.h"
#include "exit_codes.h"
#include "open_run.h"
#include "options.h"
#include "show_progress.h"
#include "stop_signal.h"

namespace pliant_cli {
namespace {

namespace fs = std::filesystem;

struct ExportCommand {
  std::string run, folder;
  FrameOptions frames;
  std::string format;
  ColorOptions colors;
  bool quiet = false, force = false;
};

int export_meshes(const ExportCommand& command) {
  const OpenRun run = open_run(command.run);
  apply_colors(command.colors, *run.scene);
  const std::vector<std::int64_t> frames = parse_frames(command.frames).frames(run.frames());
  const fs::path folder =
      command.folder.empty() ? fs::path(command.run) / pliant::kMeshFolder : fs::path(command.folder);
  prepare_frame_folder(folder, frames, command.format, command.force);
  catch_stop_signals();
  const std::unique_ptr<pliant::Progress> progress = make_progress(command.quiet);
  pliant::write_mesh_frames(folder,
                            command.format == "obj" ? pliant::MeshFormat::obj : pliant::MeshFormat::ply,
                            *run.scene, *run.model, *run.recording, run.record.frame_rate, frames, *progress);
  return kDone;
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ExportCommand>();
  CLI::App* command =
      app.add_subcommand("export", "Write the surfaces of the frames of a run, from its recording");
  command->add_option("run", options->run, "Folder of the run")->required()->type_name("RUN");
  command->add_option("--to", options->format, "Format: obj (text, with colours) or ply (binary)")
      ->required()
      ->check(CLI::IsMember({"obj", "ply"}))
      ->option_text("obj|ply");
  command->add_option("-o,--out", options->folder, "Folder for the files [RUN/meshes]")->type_name("DIR");
  add_frame_options(*command, options->frames);
  add_color_by(*command, options->colors);
  command->add_flag("--force", options->force, "Replace files that exist");
  command->add_flag("--quiet", options->quiet, "Show no progress");
  command->footer(
      "Examples:\n"
      "  pliant export out/pull --to ply -o meshes\n"
      "  pliant export out/balloon --to ply --color-by strain      a property \"strain\" of the vertices\n"
      "  pliant export out/pull --to obj --frames 40");
  command->callback([options, &action] { action = [options] { return export_meshes(*options); }; });
}

}  // namespace pliant_cli
