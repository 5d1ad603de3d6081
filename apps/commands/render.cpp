// pliant render: draws the pictures of a recorded run again, with another camera, size or colouring if
// requested.
#include <memory>
#include <optional>

#include <pliant/io/run/run_files.h>

#include "color_options.h"
#include "command.h"
#include "draw_frames.h"
#include "exit_codes.h"
#include "graphics_option.h"
#include "open_run.h"
#include "options.h"
#include "show_progress.h"
#include "stop_signal.h"

namespace pliant_cli {
namespace {

namespace fs = std::filesystem;

struct RenderCommand {
  std::string run, folder, size;
  FrameOptions frames;
  ColorOptions colors;
  std::vector<double> eye, target;
  std::optional<double> field_of_view;
  bool quiet = false, force = false, no_ground = false, no_springs = false, no_shadows = false;
  pliant::GlBackend backend = pliant::GlBackend::automatic;
};

void change_view(const RenderCommand& command, pliant::Scene& scene) {
  if (!command.size.empty()) {
    const PictureSize size = parse_picture_size(command.size);
    scene.width = size.width;
    scene.height = size.height;
  }
  if (!command.eye.empty())
    scene.camera.eye = pliant::Vec3<double>(command.eye[0], command.eye[1], command.eye[2]);
  if (!command.target.empty())
    scene.camera.target = pliant::Vec3<double>(command.target[0], command.target[1], command.target[2]);
  scene.camera.field_of_view = command.field_of_view.value_or(scene.camera.field_of_view);
  apply_colors(command.colors, scene);
  if (command.no_ground) scene.ground.visible = false;
  if (command.no_springs) scene.show_springs = false;
  if (command.no_shadows) scene.light.shadows = false;
}

int render(const RenderCommand& command) {
  const OpenRun run = open_run(command.run);
  change_view(command, *run.scene);
  const std::vector<std::int64_t> frames = parse_frames(command.frames).frames(run.frames());
  const fs::path folder =
      command.folder.empty() ? fs::path(command.run) / pliant::kFrameFolder : fs::path(command.folder);
  pliant::require_picture_memory(run.scene->width, run.scene->height);
  prepare_frame_folder(folder, frames, "png", command.force);
  catch_stop_signals();
  const std::unique_ptr<pliant::Progress> progress = make_progress(command.quiet);
  draw_frames(folder, {*run.scene, *run.model, *run.recording}, run.record.frame_rate, frames, *progress,
              command.backend);
  return kDone;
}

}  // namespace

void add_render(CLI::App& app, Action& action) {
  const auto options = std::make_shared<RenderCommand>();
  CLI::App* command = app.add_subcommand("render", "Draw the frames of a run again, from its recording");
  command->add_option("run", options->run, "Folder of the run")->required()->type_name("RUN");
  command->add_option("-o,--out", options->folder, "Folder for the pictures [RUN/frames]")->type_name("DIR");
  add_frame_options(*command, options->frames);
  command->add_option("--size", options->size, "Size of the pictures in pixels [size of the run]")
      ->check(picture_size())
      ->type_name("WxH");
  add_color_options(*command, options->colors);
  command->add_option("--camera-eye", options->eye, "Position of the camera (m)")
      ->expected(3)
      ->check(any_number())
      ->option_text("X Y Z");
  command->add_option("--camera-target", options->target, "Point that the camera looks at (m)")
      ->expected(3)
      ->check(any_number())
      ->option_text("X Y Z");
  command->add_option("--fov", options->field_of_view, "Vertical field of view, 5 to 120 degrees")
      ->check(number_between(5, 120))
      ->type_name("DEGREES");
  command->add_flag("--no-ground", options->no_ground, "Hide the ground");
  command->add_flag("--no-springs", options->no_springs, "Hide springs and joints");
  command->add_flag("--no-shadows", options->no_shadows, "Draw no shadows");
  add_graphics_option(*command, options->backend);
  command->add_flag("--force", options->force, "Replace pictures that exist");
  command->add_flag("--quiet", options->quiet, "Show no progress");
  command->footer(
      "Examples:\n"
      "  pliant render out/pull --size 1920x1080 -o out/pull-hd\n"
      "  pliant render out/pull --frames 0:100:10 --camera-eye 4 -3 2 -o out/pull-side\n"
      "  pliant render out/balloon --color-by strain --color-range 0 2 -o out/balloon-strain\n"
      "  for i in 1 2; do pliant render out/pull --shard $i/2 & done; wait\n"
      "  ffmpeg -framerate 25 -i out/pull/frames/frame_%06d.png -pix_fmt yuv420p pull.mp4");
  command->callback([options, &action] {
    check_colors(options->colors);
    action = [options] { return render(*options); };
  });
}

}  // namespace pliant_cli
