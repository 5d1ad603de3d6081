// pliant run: simulates a scene, records it in a folder, and writes meshes and pictures of its frames on
// request.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <pliant/io/format/number_text.h>
#include <pliant/io/frame_range.h>
#include <pliant/io/mesh_frames.h>
#include <pliant/io/run/energy_gate.h>
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
  double checkpoint_every = pliant::kStandardCheckpointInterval;
  bool obj = false, png = false, quiet = false, force = false, resume = false, estimate = false,
       strict = false, not_strict = false;
  int threads = 0;
  pliant::GlBackend backend = pliant::GlBackend::automatic;
  std::vector<std::string> command_line;
};

fs::path folder_of(const RunCommand& command) {
  if (!command.folder.empty()) return command.folder;
  return fs::path("out") /
         (command.scene.file == "-" ? fs::path("scene") : fs::path(command.scene.file).stem());
}

// Sets the options of the command line in the scene. A resumed run keeps its old settings, unless the command
// line changes them. --step removes the tolerance; without --integrator it replaces "auto" by the method
// of the paper. --integrator with a method of fixed steps replaces "auto" and its tolerance. --tolerance
// without --integrator selects "auto" if the method of the scene has no error control. "auto" without a
// tolerance gets the standard tolerance.
void apply_options(const RunCommand& command, const std::optional<pliant::RunRecord>& previous,
                   pliant::Scene& scene) {
  if (previous) {
    scene.end = previous->end;
    if (previous->tolerance == 0) scene.step = previous->requested_step;
    scene.tolerance = previous->tolerance;
    scene.integrator = previous->requested_integrator;
    scene.frame_rate = previous->frame_rate;
    scene.width = previous->width;
    scene.height = previous->height;
  }
  apply_colors(command.colors, scene);
  scene.end = command.end.value_or(scene.end);
  if (command.step) {
    scene.step = *command.step;
    scene.tolerance = 0;
    if (scene.integrator == pliant::kAutomatic) scene.integrator = pliant::kFixedStepIntegrator;
  }
  const bool was_automatic = scene.integrator == pliant::kAutomatic;
  if (!command.integrator.empty()) scene.integrator = command.integrator;
  const std::vector<std::string> controlled = pliant::controlled_integrators();
  const bool fixed_step =
      scene.integrator != pliant::kAutomatic &&
      std::find(controlled.begin(), controlled.end(), scene.integrator) == controlled.end();
  if (command.tolerance) {
    scene.tolerance = *command.tolerance;
    if (command.integrator.empty() && fixed_step) scene.integrator = pliant::kAutomatic;
  } else if (was_automatic && fixed_step) {
    scene.tolerance = 0;
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
      const pliant::Recording recording = run.recording();
      draw_frames(folder, {scene, model, recording}, scene.frame_rate, frames, progress, command.backend);
    });
  }
}

void print_error(const pliant::ErrorEstimate& error) {
  std::cout << "largest differences from a more accurate run with ";
  if (error.tolerance > 0)
    std::cout << "a tolerance of " << error.tolerance;
  else
    std::cout << "steps of " << error.step << " s";
  const auto print = [](const char* what, double value, const char* unit) {
    if (value != 0) std::cout << "\n  " << what << " " << pliant::rounded_text(value) << " " << unit;
  };
  print("position", error.place, "m");
  print("rotation", error.rotation, "rad");
  print("parameters with the unit of length", error.length, "m");
  print("other parameters", error.parameter, "");
  print("local displacement", error.displacement, "m; for modes m kg^(1/2)");
  print("velocity", error.velocity, "m/s");
  print("angular velocity", error.angular_velocity, "rad/s");
  print("energy", error.energy, "J");
  print("joint force, without impulses of contacts", error.joint_force, "N");
  print("joint torque, without impulses of contacts", error.joint_torque, "N m");
  print("largest joint gap of this run", error.gap, "m");
  std::cout << "\n";
}

/// Returns "; largest violation of the laws of contact R m/s, largest overlap D m" with the values of a run;
/// empty without contact.
std::string contact_summary(const pliant::Run& run) {
  const pliant::StepCounters& counters = run.record().work.steps;
  if (!run.scene().body.contact.active) return {};
  return "; largest violation of the laws of contact " + pliant::rounded_text(counters.contact_residual) +
         " m/s, largest overlap " + pliant::rounded_text(counters.contact_overlap) + " m";
}

/// Prints the last line of a run: its steps and its errors.
void print_summary(const pliant::Run& run) {
  const pliant::RunRecord& record = run.record();
  std::cout << run.folder().string() << ": t = " << record.time << " s, "
            << pliant::count_text(record.steps_done, "step") << ", "
            << pliant::count_text(record.states, "state") << " recorded; largest error of the energy balance "
            << pliant::rounded_text(record.max_balance_error) << " J, "
            << pliant::rounded_text(100 * record.energy_share, 2) << " % of the energy that could move ("
            << pliant::rounded_text(record.movable_energy) << " J)" << contact_summary(run) << "\n";
}

int run_scene(const RunCommand& command) {
  const fs::path folder = folder_of(command);
  SceneOptions asked = command.scene;
  std::optional<pliant::RunRecord> previous;
  const fs::path record = command.resume ? pliant::find_run_file(folder) : fs::path();
  if (!record.empty()) {
    previous = pliant::read_run_record(record);
    if (asked.overrides.empty()) asked.overrides = previous->overrides;
  }
  const std::unique_ptr<pliant::Scene> scene = read(asked);
  apply_options(command, previous, *scene);

  // These calls throw before the simulation starts if a later stage would fail: the estimate of the error,
  // the number of frames, the memory for a picture, the graphics library.
  if (command.estimate) pliant::require_better_run(*scene);
  if (command.obj || command.png) pliant::FrameRange().size(pliant::schedule_of(*scene).frames());
  pliant::RunOptions options;
  if (command.png) {
    pliant::require_picture_memory(scene->width, scene->height);
    options.graphics = require_graphics(command.backend);
  }

  catch_stop_signals();
  const std::unique_ptr<pliant::Progress> progress = make_progress(command.quiet);
  options.folder = folder;
  options.existing = command.resume  ? pliant::Existing::resume
                     : command.force ? pliant::Existing::force
                                     : pliant::Existing::refuse;
  options.threads = command.threads;
  options.checkpoint_every = command.checkpoint_every;
  options.scene_file = command.scene.file;
  options.command = command.command_line;
  options.stop = [] { return stop_signal() != 0; };
  std::optional<pliant::Run> prepared;
  try {
    prepared.emplace(*scene, std::move(options), *progress);
  } catch (const pliant::ChoiceStopped&) {
    std::cerr << "pliant: stopped while the integrator was chosen; nothing has been written\n";
    return kSignal + stop_signal();
  }
  pliant::Run& run = *prepared;
  if (!command.quiet && scene->tolerance == 0 && std::isfinite(run.record().stable_step))
    progress->note("step " + pliant::number_text(run.record().step) +
                   " s; the largest stable step at the start is about " +
                   pliant::rounded_text(run.record().stable_step) + " s");
  if (!run.simulate()) {
    run.finish(pliant::RunRecord::Status::stopped, "by signal " + std::to_string(stop_signal()));
    std::cerr << "pliant: stopped at t = " << run.simulation().time() << " s; continue with --resume\n";
    return kSignal + stop_signal();
  }
  try {
    if (command.estimate) print_error(run.estimate_error());
    write_frames(command, run, *progress);
  } catch (const pliant::Interrupted&) {
    std::cerr << "pliant: stopped while writing files; the motion is recorded; continue with --resume\n";
    return kSignal + stop_signal();
  }
  run.finish(pliant::RunRecord::Status::complete);
  if (!command.quiet) print_summary(run);
  const bool strict = command.strict || !(command.not_strict || pliant::is_of_first_order(run.simulation()));
  return strict && run.record().energy_share > pliant::kReportedEnergyShare ? kBoundExceeded : kDone;
}

std::vector<std::string> integrator_names() {
  std::vector<std::string> names{pliant::kAutomatic};
  for (const pliant::IntegratorInfo& info : pliant::all_integrators()) names.emplace_back(info.name);
  return names;
}

// Declares the options of time integration.
void add_time_options(CLI::App& command, RunCommand& options) {
  command.add_option("--end", options.end, "End time of the run (s)")
      ->check(number_from_zero())
      ->type_name("T");
  CLI::Option* step = command.add_option("--step", options.step, "Fixed time step (s)")
                          ->check(positive_number())
                          ->type_name("H");
  command
      .add_option("--tolerance", options.tolerance,
                  "Error tolerance of a step; the step length is then adaptive")
      ->check(positive_number())
      ->excludes(step)
      ->type_name("E");
  command
      .add_option("--integrator", options.integrator,
                  "Method of time integration (see pliant list integrators)")
      ->check(CLI::IsMember(integrator_names()))
      ->option_text("NAME");
  command.add_option("--fps", options.frame_rate, "Recorded states and frames per second of simulated time")
      ->check(positive_number())
      ->type_name("N");
}

// Declares the options of meshes and pictures.
void add_output_options(CLI::App& command, RunCommand& options) {
  command.add_flag("--obj", options.obj, "Write the surfaces of every frame as OBJ files");
  command.add_flag("--png", options.png, "Draw a picture of every frame");
  command.add_option("--size", options.size, "Size of the pictures in pixels")
      ->check(picture_size())
      ->type_name("WxH");
  add_color_options(command, options.colors);
  add_graphics_option(command, options.backend);
}

}  // namespace

void add_run(CLI::App& app, Action& action, const std::vector<std::string>& command_line) {
  const auto options = std::make_shared<RunCommand>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand("run", "Simulate a scene and record its motion");
  add_scene_options(*command, options->scene);
  command->add_option("-o,--out", options->folder, "Folder for all output [out/SCENE]")->type_name("DIR");
  add_time_options(*command, *options);
  add_output_options(*command, *options);
  command
      ->add_option("--threads", options->threads,
                   "Number of threads [as many as are useful]; results do not depend on it")
      ->check(count_up_to(4096))
      ->type_name("N");
  command->add_flag(
      "--estimate-error", options->estimate,
      "Repeat the run with a tenth of the tolerance, or with half the step, and print the differences; "
      "steps with resting contacts are halved in both cases");
  CLI::Option* strict = command->add_flag("--strict", options->strict,
                                          "End with exit code 6 if the error of the energy balance exceeds 1 "
                                          "% of the energy that could move (the default with "
                                          "a tolerance or a method of order 2 or higher)");
  command->add_flag("--no-strict", options->not_strict, "End with exit code 0 in this case")
      ->excludes(strict);
  command->add_flag("--quiet", options->quiet, "Show no progress, notes or summary");
  CLI::Option* force = command->add_flag("--force", options->force, "Replace the run in the folder");
  command
      ->add_option(
          "--checkpoint-every", options->checkpoint_every,
          "Wall time between two checkpoints (s), from which a killed run is resumed; 0: one after every "
          "step [30]")
      ->check(number_from_zero())
      ->type_name("S");
  command
      ->add_flag("--resume", options->resume,
                 "Continue the run in the folder; the result has the same bits as that of an uninterrupted "
                 "run")
      ->excludes(force);
  command->footer(
      "Examples:\n"
      "  pliant run scenes/tumbling.json --obj --png -o out/tumbling\n"
      "  pliant run scenes/balloon.json --png --color-by strain\n"
      "  pliant run scenes/pull.json --set /parts/0/density=40 --set /gravity=[0,0,-1] --end 2\n"
      "  pliant run scenes/pull.json -o out/pull --resume --end 20    extend a run, or continue after "
      "Ctrl-C\n"
      "Output: run.json (status, options, timings), trajectory.csv, the recording (t.npy, q.npy, v.npy, "
      "modes.npy,\n"
      "work.npy and supports.npy, described in layout.json), meshes/ and frames/. With \"output\": "
      "{\"contacts\": "
      "true} in the\n"
      "scene also contacts.csv and joint_impulses.csv.");
  command->callback([options, &action] {
    check_colors(options->colors);
    action = [options] { return run_scene(*options); };
  });
}

}  // namespace pliant_cli
