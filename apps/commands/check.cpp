// pliant check: checks a scene and estimates the cost of a run. Writes no files.
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include <pliant/io/checksums.h>
#include <pliant/io/format/number_text.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/scheduled_step.h>
#include <pliant/io/run/wall_clock.h>
#include <pliant/io/state_row.h>
#include <pliant/io/work_row.h>
#include <pliant/scene/read_scene.h>
#include <pliant/simulate/stable_step.h>

#include "command.h"
#include "exit_codes.h"
#include "scene_options.h"

namespace pliant_cli {
namespace {

struct CheckCommand {
  SceneOptions scene;
  std::string diagnostics = "text";
};

// Returns an estimate of the wall-clock time of a run, s, or 0 for a run without steps. Performs steps of the
// run for 0.4 s, or for 0.7 s if bodies can touch. If these steps do not reach the end of the run, their time
// is extrapolated. If bodies can touch, the whole time is used, because the first impacts may cost more than
// all later contacts. Otherwise the first quarter of the 0.4 s is left out, because the first steps with a
// tolerance are short.
double seconds_of_run(pliant::Simulation& simulation, const pliant::FrameSchedule& schedule) {
  const bool contact = simulation.model().body().contact.active;
  const double trial = contact ? 0.7 : 0.4, first = contact ? 0 : trial / 4;
  const pliant::WallClock::time_point start = pliant::WallClock::now();
  double seconds = 0, first_seconds = 0, first_time = 0;
  while (!pliant::at_end(simulation, schedule) && seconds < trial) {
    pliant::scheduled_step(simulation, schedule);
    seconds = pliant::seconds_since(start);
    if (seconds > first) continue;
    first_seconds = seconds;
    first_time = simulation.time();
  }
  if (pliant::at_end(simulation, schedule)) return seconds;
  const double rate = (seconds - first_seconds) / (simulation.time() - first_time);
  return seconds + rate * (schedule.end() - simulation.time());
}

// Returns the number of obstacles as text, for example ", 2 obstacles of 644 triangles", or an empty text if
// there are no obstacles.
std::string obstacle_text(const pliant::MultiBody& body) {
  const auto& obstacles = body.contact.obstacles;
  std::int64_t triangles = 0;
  for (const pliant::ContactObstacle& obstacle : obstacles) triangles += obstacle.triangles.cols();
  if (obstacles.empty()) return "";
  return ", " + pliant::count_text(static_cast<std::int64_t>(obstacles.size()), "obstacle") + " of " +
         pliant::count_text(triangles, "triangle");
}

// Returns the count of numbers that are recorded for a state, in all tables with one row per state.
std::size_t numbers_per_state(const pliant::Model& model, bool in_clusters) {
  return 1 + static_cast<std::size_t>(model.n_q() + model.n_v()) + pliant::mode_count(model, in_clusters) +
         pliant::work_columns().size() + pliant::checksum_columns(pliant::checked_tables(model)).size();
}

void print_estimate(pliant::Scene& scene) {
  const pliant::FrameSchedule schedule = pliant::schedule_of(scene);
  pliant::Simulation simulation(scene.body, scene.integrator, 1, scene.tolerance);
  const pliant::StableStep stable = pliant::stable_step(simulation);
  std::cout << "ok: " << pliant::count_text(static_cast<std::int64_t>(scene.body.parts().size()), "part")
            << obstacle_text(scene.body) << ", " << simulation.model().n_v() << " degrees of freedom\n"
            << "estimate: ";
  if (scene.tolerance > 0)
    std::cout << "adaptive steps with a tolerance of " << scene.tolerance;
  else
    std::cout << schedule.steps() << " steps of " << schedule.step() << " s";
  if (scene.tolerance == 0 && schedule.step() > stable.step)
    std::cout << "\nwarning: the step is larger than the largest stable step of about "
              << pliant::rounded_text(stable.step) << " s, which is limited by " << stable.limit
              << "; choose a smaller --step";
  else
    std::cout << ", about " << pliant::rounded_text(seconds_of_run(simulation, schedule), 2)
              << " s of computation";
  const pliant::Model& model = simulation.model();
  const std::size_t numbers = numbers_per_state(model, simulation.clusters() != nullptr);
  std::cout << "; " << pliant::count_text(schedule.frames(), "frame") << ", a recording of "
            << (model.body().contact.active ? "at least " : "")
            << pliant::rounded_text(
                   static_cast<double>(schedule.frames()) * static_cast<double>(numbers) * 8 / 1e6, 2)
            << " MB\n";
}

// Prints the time (s) that reading and preparing a scene took, if this time is noticeable.
void print_preparation(double seconds) {
  constexpr double kNoticeable = 1;
  if (seconds > kNoticeable)
    std::cout << "reading and preparing the scene took " << pliant::rounded_text(seconds, 2)
              << " s, and takes as long in every run\n";
}

int check(const CheckCommand& command) {
  const pliant::WallClock::time_point start = pliant::WallClock::now();
  const bool machine = command.diagnostics == "json";
  pliant::Diagnostics diagnostics;
  std::unique_ptr<pliant::Scene> scene;
  try {
    scene = pliant::read_scene(command.scene.file, command.scene.overrides, diagnostics, solvers());
  } catch (const pliant::SceneError& error) {
    if (!machine) throw;
    std::cout << error.diagnostics().json() << "\n";
    return kInput;
  }
  if (machine)
    std::cout << diagnostics.json() << "\n";
  else if (diagnostics.warnings() > 0)
    std::cerr << diagnostics.text();
  if (machine) return kDone;
  const double preparation = pliant::seconds_since(start);
  print_estimate(*scene);
  print_preparation(preparation);
  return kDone;
}

}  // namespace

void add_check(CLI::App& app, Action& action) {
  const auto options = std::make_shared<CheckCommand>();
  CLI::App* command =
      app.add_subcommand("check", "Check a scene and estimate the cost of a run; writes no files");
  add_scene_options(*command, options->scene);
  command
      ->add_option("--diagnostics", options->diagnostics,
                   "Format of the fault reports: text, or json for other programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->option_text("text|json");
  command->footer(
      "Example:\n  pliant check scenes/pull.json\n"
      "Each fault is reported as  file:line:column: error: /json/pointer: the fault; the expected value.");
  command->callback([options, &action] { action = [options] { return check(*options); }; });
}

}  // namespace pliant_cli
