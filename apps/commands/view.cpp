// pliant view: shows a running scene or a recorded run in a window.
#include <filesystem>
#include <iostream>
#include <memory>

#include <pliant/io/run/run_files.h>
#include <pliant/view/viewer.h>

#include "command.h"
#include "exit_codes.h"
#include "failure.h"
#include "open_run.h"
#include "options.h"
#include "scene_options.h"

namespace pliant_cli {
namespace {

namespace fs = std::filesystem;

struct ViewCommand {
  SceneOptions scene;
  std::string size, saved;
  pliant::ViewOptions view;
};

void show(const ViewCommand& command) {
  pliant::ViewOptions options = command.view;
  if (!command.size.empty()) {
    const PictureSize size = parse_picture_size(command.size);
    options.width = size.width;
    options.height = size.height;
  }
  const fs::path file = command.scene.file;
  if (fs::is_directory(file)) {
    const OpenRun run = open_run(file);
    pliant::view_recording(*run.scene, *run.model, *run.recording, options, std::cout);
    return;
  }
  const std::unique_ptr<pliant::Scene> scene = read(command.scene);
  options.scene_folder = file.parent_path();
  const std::string stem = command.scene.file == "-" ? "scene" : file.stem().string();
  options.saved = command.saved.empty() ? stem + "-played.json" : command.saved;
  pliant::view_scene(*scene, options, std::cout);
}

int view(const ViewCommand& command) {
  try {
    show(command);
  } catch (const pliant::NoWindow& failure) {
    throw ResourceFailure(failure.what());
  }
  return kDone;
}

}  // namespace

void add_view(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ViewCommand>();
  CLI::App* command =
      app.add_subcommand("view", "Show a running scene, or the recording of a run, in a window");
  add_scene_options(*command, options->scene);
  command->get_option("scene")
      ->description("Scene file (JSON), or the folder of a run")
      ->type_name("SCENE|RUN");
  command->add_option("-o,--out", options->saved, "File that the button \"save\" writes [SCENE-played.json]")
      ->type_name("FILE");
  command->add_option("--size", options->size, "Size of the window in pixels [960x540]")
      ->check(picture_size())
      ->type_name("WxH");
  command->add_flag("--play", options->view.plays, "Start to play at once");
  command
      ->add_option(
          "--threads", options->view.threads,
          "Number of threads of the simulation [by the cost of the scene, at most all processors but one]; "
          "results do not depend on it")
      ->check(count_up_to(4096))
      ->type_name("N");
  command->add_option("--script", options->view.script, "File of synthetic input, for tests")
      ->type_name("FILE");
  command
      ->add_option(
          "--bench", options->view.bench,
          "Play for this wall time (s), print pictures per second and simulated time / wall time, and close")
      ->check(positive_number())
      ->type_name("S");
  command->footer(
      "Mouse: the left button drags the part under the pointer by a spring; where there is no part, it "
      "turns\n"
      "the view, as the right button does; the middle button, or Shift and the left one, moves the view; "
      "the\n"
      "wheel zooms.\n"
      "Keys: space plays and pauses, s makes one step, r resets, w saves, Escape closes; c, f, j and m "
      "switch\n"
      "strain colours, forces, joints and springs, and meshes on and off.\n"
      "Examples:\n"
      "  pliant view scenes/snowman.json --play\n"
      "  pliant view out/pull");
  command->callback([options, &action] { action = [options] { return view(*options); }; });
}

}  // namespace pliant_cli
