// pliant run: simulates a scene into a folder, and writes meshes and pictures of its frames when asked.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <pliant/io/format/number_text.h>
#include <pliant/io/frame_range.h>
#include <pliant/io/mesh_frames.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/run_files.h>

#include "color_options.h"
#include "command.h"
#include "draw_frames.h"
#include "exit_codes.h"
#include "graphics_option.h"
#include "options.h"
#include "scene_options.h"
#include "show_progress.h"
#include "stop_signal.h"

namespace pliant_cli {
namespace {

namespace fs = std::filesystem;

struct RunCommand {
  SceneOptions scene;
  ColorOptions colors;
  std::string folder, size, integrator;
  std::optional<double> end, step, tolerance, frame_rate;
  bool obj = false, png = false, quiet = false, force = false, resume = false, estimate = false;
  int threads = 0;
  pliant::GlBackend backend = pliant::GlBackend::automatic;
  std::vector<std::string> command_line;
};

fs::path folder_of(const RunCommand& command) {
  if (!command.folder.empty()) return command.folder;
  return fs::path("out") /
         (command.scene.file == "-" ? fs::path("scene") : fs::path(command.scene.file).stem());
}

// What the command line says of how to run; a resumed run goes on as it began where it says nothing.
void apply_options(const RunCommand& command, const std::optional<pliant::RunRecord>& begun,
                   pliant::Scene& scene) {
  if (begun) {
    scene.end = begun->end;
    if (begun->tolerance == 0) scene.step = begun->asked_step;
    scene.tolerance = begun->tolerance;
    scene.integrator = begun->asked_integrator;
    scene.frame_rate = begun->frame_rate;
    scene.width = begun->width;
    scene.height = begun->height;
  }
  apply_colors(command.colors, scene);
  scene.end = command.end.value_or(scene.end);
  if (command.step) {
    scene.step = *command.step;
    scene.tolerance = 0;
  }
  if (!command.integrator.empty()) scene.integrator = command.integrator;
  if (command.tolerance) {
    scene.tolerance = *command.tolerance;
    const std::vector<std::string> controlled = pliant::controlled_integrators();
    if (command.integrator.empty() &&
        std::find(controlled.begin(), controlled.end(), scene.integrator) == controlled.end())
      scene.integrator = pliant::kAutomatic;
  }
  if (scene.integrator == pliant::kAutomatic && scene.tolerance == 0)
    scene.tolerance = pliant::kStandardTolerance;
  scene.frame_rate = command.frame_rate.value_or(scene.frame_rate);
  if (!command.size.empty()) {
    const PictureSize size = parse_picture_size(command.size);
    scene.width = size.width;
    scene.height = size.height;
  }
}

void write_frames(const RunCommand& command, pliant::Run& run, pliant::Progress& progress) {
  if (!command.obj && !command.png) return;
  const std::vector<std::int64_t> frames =
      pliant::FrameRange().frames(run.schedule().frames(run.simulation().time()));
  const pliant::Scene& scene = run.scene();
  const pliant::Model& model = run.simulation().model();
  const auto series = [](const char* folder, const char* ending) {
    return std::string(folder) + "/frame_*." + ending;
  };
  if (command.obj) {
    run.write("meshes",
              {series(pliant::kMeshFolder, "obj"), fs::path(pliant::kMeshFolder) / pliant::kMaterialFile},
              [&] {
                const fs::path folder = run.folder() / pliant::kMeshFolder;
                pliant::make_subfolder(folder);
                pliant::write_mesh_frames(folder, pliant::MeshFormat::obj, scene, model, run.recording(),
                                          scene.frame_rate, frames, progress);
              });
  }
  if (command.png) {
    run.write("frames", {series(pliant::kFrameFolder, "png")}, [&] {
      const fs::path folder = run.folder() / pliant::kFrameFolder;
      pliant::make_subfolder(folder);
      draw_frames(folder, scene, model, run.recording(), scene.frame_rate, frames, progress, command.backend);
    });
  }
}

void print_error(const pliant::ErrorEstimate& error) {
  std::cout << "error, by a run ";
  if (error.tolerance > 0)
    std::cout << "to a tolerance of " << error.tolerance;
  else
    std::cout << "with steps of " << error.step << " s";
  const auto tell = [](const char* what, double value, const char* unit) {
    if (value != 0) std::cout << "\n  " << what << " " << pliant::rounded_text(value) << " " << unit;
  };
  tell("place", error.place, "m");
  tell("rotation", error.rotation, "rad");
  tell("parameters that are lengths", error.length, "m");
  tell("other parameters", error.parameter, "");
  tell("local displacement", error.displacement, "m, or of modes m kg^(1/2)");
  tell("velocity", error.velocity, "m/s");
  tell("angular velocity", error.angular_velocity, "rad/s");
  tell("energy", error.energy, "J");
  tell("force of joints, without impulses of contact", error.joint_force, "N");
  tell("torque of joints, without them", error.joint_torque, "N m");
  tell("gap of joints, of this run", error.gap, "m");
  std::cout << "\n";
}

int run_scene(const RunCommand& command) {
  const fs::path folder = folder_of(command);
  SceneOptions asked = command.scene;
  std::optional<pliant::RunRecord> begun;
  if (command.resume) {
    begun = pliant::read_run_record(folder / pliant::kRunFile);
    if (asked.overrides.empty()) asked.overrides = begun->overrides;
  }
  const std::unique_ptr<pliant::Scene> scene = read(asked);
  apply_options(command, begun, *scene);

  // What would fail after the simulation fails before it.
  if (command.estimate) pliant::require_better_run(*scene);
  if (command.obj || command.png) pliant::FrameRange().size(pliant::schedule_of(*scene).frames());
  pliant::RunOptions options;
  if (command.png) options.graphics = require_graphics(command.backend);

  catch_stop_signals();
  const std::unique_ptr<pliant::Progress> progress = make_progress(command.quiet);
  options.folder = folder;
  options.existing = command.resume  ? pliant::Existing::resume
                     : command.force ? pliant::Existing::force
                                     : pliant::Existing::refuse;
  options.threads = command.threads;
  options.scene_file = command.scene.file;
  options.command = command.command_line;
  options.stop = [] { return stop_signal() != 0; };
  pliant::Run run(*scene, std::move(options), *progress);
  if (!command.quiet && scene->tolerance == 0 && std::isfinite(run.record().stable_step))
    progress->note("step " + pliant::number_text(run.record().step) +
                   " s; the largest stable one at the start is about " +
                   pliant::rounded_text(run.record().stable_step) + " s");
  if (!run.simulate()) {
    run.finish(pliant::RunRecord::Status::stopped, "by signal " + std::to_string(stop_signal()));
    std::cerr << "pliant: stopped at t = " << run.simulation().time() << " s; go on with --resume\n";
    return kSignal + stop_signal();
  }
  try {
    if (command.estimate) print_error(run.estimate_error());
    write_frames(command, run, *progress);
  } catch (const pliant::Interrupted&) {
    std::cerr << "pliant: stopped while writing files; the motion is recorded: go on with --resume\n";
    return kSignal + stop_signal();
  }
  run.finish(pliant::RunRecord::Status::complete);
  if (!command.quiet)
    std::cout << folder.string() << ": t = " << run.record().time << " s, "
              << pliant::count_text(run.record().steps_done, "step") << ", "
              << pliant::count_text(run.record().states, "state") << " recorded; largest balance error "
              << pliant::rounded_text(run.record().max_balance_error) << " J\n";
  return kDone;
}

std::vector<std::string> integrator_names() {
  std::vector<std::string> names{pliant::kAutomatic};
  for (const pliant::IntegratorInfo& info : pliant::all_integrators()) names.emplace_back(info.name);
  return names;
}

}  // namespace

void add_run(CLI::App& app, Action& action, const std::vector<std::string>& command_line) {
  const auto options = std::make_shared<RunCommand>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand("run", "Simulate a scene and record its motion");
  add_scene_options(*command, options->scene);
  command->add_option("-o,--out", options->folder, "Folder for everything that is written [out/SCENE]")
      ->type_name("DIR");
  command->add_option("--end", options->end, "End of the run, s")->check(number_from_zero())->type_name("T");
  CLI::Option* step = command->add_option("--step", options->step, "Time step, s: all are so long")
                          ->check(positive_number())
                          ->type_name("H");
  command->add_option("--tolerance", options->tolerance, "Error of a step, which then finds its own length")
      ->check(positive_number())
      ->excludes(step)
      ->type_name("E");
  command->add_option("--integrator", options->integrator, "Method of time integration, see pliant list")
      ->check(CLI::IsMember(integrator_names()))
      ->option_text("NAME");
  command->add_option("--fps", options->frame_rate, "Recorded states and frames per second of the motion")
      ->check(positive_number())
      ->type_name("N");
  command->add_flag("--obj", options->obj, "Write the surfaces of every frame as OBJ files");
  command->add_flag("--png", options->png, "Draw a picture of every frame");
  command->add_option("--size", options->size, "Size of pictures, pixels")
      ->check(picture_size())
      ->type_name("WxH");
  add_color_options(*command, options->colors);
  add_graphics_option(*command, options->backend);
  command
      ->add_option("--threads", options->threads,
                   "Threads [as many as are of use]; results do not depend on it")
      ->check(count_up_to(4096))
      ->type_name("N");
  command->add_flag(
      "--estimate-error", options->estimate,
      "Run again, to a tenth of the tolerance or with half the step, and where bodies lie on each "
      "other with half the step, and tell the differences");
  command->add_flag("--quiet", options->quiet, "Show errors only");
  CLI::Option* force = command->add_flag("--force", options->force, "Replace the run that is in the folder");
  command
      ->add_flag("--resume", options->resume,
                 "Go on with the run that is in the folder, to the last bit as if unbroken")
      ->excludes(force);
  command->footer(
      "Examples:\n"
      "  pliant run scenes/tumbling.json --obj --png -o out/tumbling\n"
      "  pliant run scenes/balloon.json --png --color-by strain\n"
      "  pliant run scenes/pull.json --set /parts/0/density=500 --set /gravity=[0,0,-9.81] --end 2\n"
      "  pliant run scenes/pull.json -o out/pull --resume --end 20    longer than it was, or after Ctrl-C\n"
      "The folder then holds run.json (status, options, timings), trajectory.csv, the recording (t.npy, "
      "q.npy, v.npy,\n"
      "modes.npy, supports.npy, explained by layout.json), meshes/ and frames/; and contacts.csv and\n"
      "joint_impulses.csv where the scene says \"output\": {\"contacts\": true}.");
  command->callback([options, &action] {
    check_colors(options->colors);
    action = [options] { return run_scene(*options); };
  });
}

}  // namespace pliant_cli
