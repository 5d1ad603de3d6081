// Runs and the files in their folders. A run that is interrupted and resumed writes files identical to those
// of an uninterrupted run. No folder contains files of two runs. run.json reports how a run ended.
// I49 to I59 and N30 to N67 in names of tests are rows of the tables in tests/README.md.
#include <pliant/io/run/run.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/body/joints/rod.h>
#include <pliant/io/run/run_files.h>
#include <pliant/part/local/local_laws.h>

namespace run_test {

using namespace pliant;
namespace fs = std::filesystem;

namespace {

constexpr const char* kResults[] = {kTimesFile, kCoordinatesFile, kVelocitiesFile,
                                    kModesFile, kWorkFile,        kTrajectoryFile};

/// Returns the bytes of all tables of a run.
std::string results_of(const fs::path& folder) {
  std::string bytes;
  for (const char* file : kResults) bytes += bytes_of(folder / file);
  return bytes;
}

nlohmann::json record_of(const fs::path& folder) {
  return nlohmann::json::parse(bytes_of(folder / kRunFile));
}

struct RunSettings {
  Existing existing = Existing::refuse;
  int threads = 1;
  long stop_after = -1;  // number of steps; -1: the run is not stopped
};

/// Runs a scene in a folder. Returns whether the run reached its end.
bool run(Scene& scene, const fs::path& folder, const RunSettings& settings = {}) {
  Progress silent;
  RunOptions options;
  options.folder = folder;
  options.existing = settings.existing;
  options.threads = settings.threads;
  long steps = 0;
  bool begun = false;  // `stop` is also called while the method is chosen
  if (settings.stop_after >= 0) options.stop = [&] { return begun && steps++ >= settings.stop_after; };
  Run session(scene, options, silent);
  begun = true;
  const bool complete = session.simulate();
  session.finish(complete ? RunRecord::Status::complete : RunRecord::Status::stopped,
                 complete ? "" : "by the test");
  return complete;
}

std::unique_ptr<Scene> scene_for(const std::string& integrator) {
  auto scene = pulled_scene();
  scene->integrator = integrator;
  return scene;
}

}  // namespace

TEST_CASE("N66: any number of threads gives identical files", "[long]") {
  const NewFolder folder;
  for (const char* integrator : {"semi_implicit_euler", "rk4", "linearly_implicit"}) {
    std::string first;
    for (const int threads : {1, 2, 3}) {
      const fs::path out = folder / (std::string(integrator) + std::to_string(threads));
      REQUIRE(run(*scene_for(integrator), out, {Existing::refuse, threads}));
      if (threads == 1) first = results_of(out);
      CHECK(results_of(out) == first);
    }
  }
}

TEST_CASE(
    "N67: a run that is stopped anywhere and resumed with other threads writes files identical to the "
    "unbroken run",
    "[long]") {
  const NewFolder folder;
  for (const char* integrator : {"semi_implicit_euler", "rk4", "linearly_implicit"}) {
    const fs::path unbroken = folder / (std::string(integrator) + "_unbroken");
    REQUIRE(run(*scene_for(integrator), unbroken));
    for (const long first : {0L, 1L, 19L, 20L, 57L, 199L}) {
      const fs::path broken = folder / (integrator + std::to_string(first));
      CHECK_FALSE(run(*scene_for(integrator), broken, {Existing::refuse, 1, first}));
      CHECK(record_of(broken).at("status") == "stopped");
      CHECK(record_of(broken).at("progress").at("steps_done") == first);
      run(*scene_for(integrator), broken, {Existing::resume, 3, 33});
      REQUIRE(run(*scene_for(integrator), broken, {Existing::resume, 2}));
      CHECK(results_of(broken) == results_of(unbroken));
      CHECK(record_of(broken).at("status") == "complete");
      CHECK(record_of(broken).at("progress").at("resumed") == 2);
      CHECK(record_of(broken).at("work").at("steps") == 200);
      CHECK(record_of(broken).at("work").at("evaluations") ==
            record_of(unbroken).at("work").at("evaluations"));
    }
  }
}

TEST_CASE("I53: a run that is killed at any time can be resumed to identical files") {
  const NewFolder folder;
  const fs::path unbroken = folder / "unbroken", killed = folder / "killed";
  const auto long_scene = [] {
    auto scene = pulled_scene();
    scene->end = 0.5;
    scene->frame_rate = 1000;
    return scene;
  };
  REQUIRE(run(*long_scene(), unbroken));
  {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        Progress silent;
        RunOptions options;
        options.folder = killed;
        const auto scene = long_scene();
        long steps = 0;
        options.stop = [&] {
          if (++steps > 300) ::raise(SIGKILL);
          return false;
        };
        Run session(*scene, options, silent);
        session.simulate();
      } catch (...) {
      }
      ::_exit(1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(WIFSIGNALED(status));
  }
  CHECK(record_of(killed).at("status") == "running");
  CHECK_FALSE(fs::exists(killed / kTrajectoryFile));
  REQUIRE(run(*long_scene(), killed, {Existing::resume}));
  CHECK(results_of(killed) == results_of(unbroken));
  for (const char* key : {"work", "monitors", "notes", "files", "checksums"})
    CHECK(record_of(killed).at(key) == record_of(unbroken).at(key));
}

TEST_CASE("a complete run continues to a later end as if it had never stopped") {
  const NewFolder folder;
  const auto until = [](double end) {
    auto scene = pulled_scene();
    scene->end = end;
    return scene;
  };
  REQUIRE(run(*until(0.2), folder / "a"));
  REQUIRE(run(*until(0.13), folder / "b"));  // 0.13 s is between two frames
  REQUIRE(run(*until(0.2), folder / "b", {Existing::resume}));
  CHECK(results_of(folder / "a") == results_of(folder / "b"));
  REQUIRE(run(*until(0.2), folder / "b", {Existing::resume}));  // this run has no steps
  CHECK(results_of(folder / "a") == results_of(folder / "b"));
  CHECK_THROWS_AS(run(*until(0.1), folder / "b", {Existing::resume}), RecordingMismatch);
}

namespace {
std::unique_ptr<Scene> scene_to(double tolerance, double end) {
  auto scene = pulled_scene();
  scene->integrator = kAutomatic;
  scene->tolerance = tolerance;
  scene->end = end;
  return scene;
}
}  // namespace

TEST_CASE("N67: runs with error control also write identical files when stopped or extended", "[long]") {
  const NewFolder folder;
  const fs::path unbroken = folder / "unbroken", longer = folder / "longer";
  REQUIRE(run(*scene_to(1e-7, 0.2), unbroken));
  const long steps = record_of(unbroken).at("progress").at("steps_done");
  REQUIRE(steps > 6);
  for (const long first : {0L, 1L, steps / 3, steps / 2, steps - 1}) {
    CAPTURE(first, steps);
    const fs::path broken = folder / ("broken" + std::to_string(first));
    CHECK_FALSE(run(*scene_to(1e-7, 0.2), broken, {Existing::refuse, 1, first}));
    run(*scene_to(1e-7, 0.2), broken, {Existing::resume, 2, 2});
    REQUIRE(run(*scene_to(1e-7, 0.2), broken, {Existing::resume}));
    CHECK(results_of(broken) == results_of(unbroken));
    CHECK(record_of(broken).at("progress").at("steps_done") == steps);
  }
  REQUIRE(run(*scene_to(1e-7, 0.13), longer));
  REQUIRE(run(*scene_to(1e-7, 0.2), longer, {Existing::resume}));
  CHECK(results_of(longer) == results_of(unbroken));
  CHECK_THROWS_AS(run(*scene_to(1e-6, 0.2), longer, {Existing::resume}), RecordingMismatch);
}

TEST_CASE("N67: a stiff shell, whose steps depend on its reused factors, also gives identical files") {
  auto scene_until = [](double end) {
    auto scene = std::make_unique<Scene>();
    scene->name = "shell";
    scene->end = end;
    scene->tolerance = 1e-3;
    scene->frame_rate = 50;
    scene->integrator = "linearly_implicit";
    Part& shell = scene->body.add(make_part("shell", "sphere", {}, 1));
    shell.rest({{"r", 0.5}}).make_shell();
    LocalSettings settings;
    settings.resolution = 2;
    settings.energies = {local_law("membrane", {1e8, 0.3, 0.01})};
    settings.beta = 1e-4;
    shell.deform_locally(settings).velocity({0, 0.5, 0}, {0.1, 0.2, 0.3});
    scene->body.ball("string", world(0, 0, 0.5), point(shell, kPi / 2, 0));
    scene->appearance.emplace_back();
    return scene;
  };
  const NewFolder folder;
  REQUIRE(run(*scene_until(0.2), folder / "unbroken"));
  REQUIRE(run(*scene_until(0.13), folder / "longer"));
  REQUIRE(run(*scene_until(0.2), folder / "longer", {Existing::resume}));
  CHECK(results_of(folder / "longer") == results_of(folder / "unbroken"));
  CHECK_FALSE(run(*scene_until(0.2), folder / "broken", {Existing::refuse, 1, 9}));
  REQUIRE(run(*scene_until(0.2), folder / "broken", {Existing::resume}));
  CHECK(results_of(folder / "broken") == results_of(folder / "unbroken"));
}

namespace {

/// Returns a scene in which a joint presses a ball through a floor, from the time 0.2 s on. more: text to add
/// to the formula of the height (m) of the joint.
std::unique_ptr<Scene> conflict_until(double end, const std::string& more = "") {
  auto scene = std::make_unique<Scene>();
  scene->name = "conflict";
  scene->end = end;
  scene->step = 2e-3;
  scene->frame_rate = 50;
  scene->integrator = "rk4";
  Part& part = scene->body.add(make_part("weight", "sphere", {}, 1000));
  part.rest({{"r", 0.1}}).place({0, 0, 0.2});
  scene->body.ball("pull", world(TimeVector(0, 0, TimeFunction::formula("0.3 - 0.5 * t" + more))),
                   point(part, kPi / 2, 0));
  scene->body.contact.active = true;
  scene->body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  scene->appearance.emplace_back();
  return scene;
}

}  // namespace

TEST_CASE("N57: if a joint pulls a part into a plane, run.json names the joint, the part and the plane") {
  const NewFolder folder;
  REQUIRE(run(*conflict_until(0.6), folder / "out"));
  const auto json = record_of(folder / "out");
  const std::string notes = json.at("notes").dump();
  CAPTURE(notes);
  CHECK(notes.find("part 'weight' and the plane 'floor' overlap by") != std::string::npos);
  CHECK(notes.find("unless ball 'pull' prevents it") != std::string::npos);
  // The ball reaches the floor at t = 0.2 s and is 0.2 m deep at the end.
  CHECK(
      notes.find("s velocities at contacts violated the laws of contact by 0.5 m/s. The tolerance there is "
                 "0.0005 m/s, a thousandth of the speed that the impulses stopped. Check whether a joint") !=
      std::string::npos);
  CHECK(notes.find("at t = 0.6 s bodies still overlapped after their separation by 0.2 m. The tolerance") !=
        std::string::npos);
  CHECK(notes.find("shorter step") == std::string::npos);
  const auto& monitors = json.at("monitors");
  CHECK(monitors.at("max_contact_residual") == Approx(0.5));
  CHECK(monitors.at("max_contact_overlap") == Approx(0.2).epsilon(1e-3));
  CHECK(monitors.at("worst_contact_residual").at("value") == Approx(0.5));
  CHECK(monitors.at("worst_contact_residual").at("tolerance") == Approx(5e-4));
  CHECK(monitors.at("worst_contact_overlap").at("time") == Approx(0.6));
}

TEST_CASE("a resumed run replaces its warnings about violations of contact, and a failed run has them") {
  const NewFolder folder;
  const auto warnings = [&](const char* what) {
    const auto notes = record_of(folder / "out").at("notes");
    return std::count_if(notes.begin(), notes.end(), [&](const auto& note) {
      return note.template get<std::string>().find(what) != std::string::npos;
    });
  };
  REQUIRE(run(*conflict_until(0.4), folder / "out"));
  CHECK(warnings("bodies still overlapped") == 1);
  REQUIRE(run(*conflict_until(0.6), folder / "out", {Existing::resume}));
  CHECK(warnings("bodies still overlapped") == 1);
  CHECK(warnings("at t = 0.6 s bodies still overlapped") == 1);
  CHECK(warnings("velocities at contacts violated") == 1);

  // The path ends in a pole at t = 0.9 s.
  const auto scene = conflict_until(1, " - 1e-9 / (0.9 - t)^3");
  CHECK_THROWS_AS(run(*scene, folder / "out", {Existing::force}), StepFailure);
  CHECK(record_of(folder / "out").at("status") == "failed");
  CHECK(warnings("bodies still overlapped") == 1);
  CHECK(warnings("velocities at contacts violated") == 1);
}

TEST_CASE("a resumed run keeps the largest errors of contact, and bodies at rest cause no warning") {
  const auto scene_until = [](double end) {
    auto scene = std::make_unique<Scene>();
    scene->name = "drop";
    scene->end = end;
    scene->step = 2e-3;
    scene->frame_rate = 50;
    scene->integrator = "rk4";
    for (int i = 0; i < 3; ++i)
      scene->body.add(make_part("box" + std::to_string(i), "box", {}, 1000))
          .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
          .place({0, 0, 0.15 + 0.25 * i});
    scene->body.contact.active = true;
    scene->body.contact.tolerance = 1e-3;
    scene->body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    scene->appearance.resize(3);
    return scene;
  };
  const NewFolder folder;
  REQUIRE(run(*scene_until(0.4), folder / "unbroken"));
  REQUIRE(run(*scene_until(0.3), folder / "resumed"));
  const auto first = record_of(folder / "resumed").at("monitors");
  REQUIRE(run(*scene_until(0.4), folder / "resumed", {Existing::resume}));
  const auto unbroken = record_of(folder / "unbroken"), resumed = record_of(folder / "resumed");
  CHECK(first.at("max_contact_residual") > 0.0);
  for (const char* key :
       {"max_contact_residual", "max_contact_overlap", "worst_contact_residual", "worst_contact_overlap"})
    CHECK(resumed.at("monitors").at(key) == unbroken.at("monitors").at(key));
  CHECK(unbroken.at("notes").dump().find("warning") == std::string::npos);
}

TEST_CASE("I53: a run with resting contacts, resumed from where it was stopped, gives identical files",
          "[long]") {
  auto scene_of = [] {
    auto scene = pulled_scene();
    scene->body.contact.active = true;
    scene->body.plane("floor", Vec3<double>(0, 0, -5), {0, 0, 1});
    for (int i = 0; i < 3; ++i)
      scene->body.add(make_part("box" + std::to_string(i), "box", {}, 1000))
          .rest({{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.5}})
          .place({5 + 0.1 * i, 5, -4.5 + i});
    for (std::size_t i = scene->appearance.size(); i < scene->body.parts().size(); ++i)
      scene->appearance.emplace_back();
    return scene;
  };
  const NewFolder folder;
  auto whole = scene_of(), broken = scene_of();
  REQUIRE(run(*whole, folder / "whole"));
  REQUIRE_FALSE(run(*broken, folder / "broken", {Existing::refuse, 1, 15}));
  broken = scene_of();
  REQUIRE(run(*broken, folder / "broken", {Existing::resume}));
  CHECK(results_of(folder / "broken") == results_of(folder / "whole"));
  CHECK(bytes_of(folder / "broken" / kContactCacheFile) == bytes_of(folder / "whole" / kContactCacheFile));
  CHECK(NpyReader(folder / "whole" / kContactCacheFile).rows() > 10);
}

TEST_CASE("pictures of a run with error control follow the motion within short and long steps") {
  // A free top and a bouncing ball.
  auto scene_of = [](double tolerance) {
    auto scene = free_top();
    scene->tolerance = tolerance;
    scene->integrator = "dop853";
    scene->end = 1.5;
    Part& ball = scene->body.add(make_part("ball", "sphere", {}, 1000));
    ball.rest({{"r", 0.1}}).place({3, 0, 1.1}).velocity({0.5, 0, 0}, {1, 2, 3});
    scene->body.gravity = {0, 0, -9.81};
    scene->body.contact.active = true;
    scene->body.contact.restitution = 0.8;
    scene->body.contact.planes.emplace_back().name = "floor";
    scene->body.contact.planes.front().point = TimeVector(0, 0, 0);
    scene->appearance.emplace_back();
    scene->body.parts().front()->place({0, 0, 100});
    return scene;
  };
  const NewFolder folder;
  auto scene = scene_of(1e-5), exact = scene_of(1e-11);
  Progress silent;
  RunOptions options;
  options.folder = folder / "run";
  Run session(*scene, options, silent);
  REQUIRE(session.simulate());
  CHECK(session.simulation().step_counters().steps < 60);
  Simulation simulation(exact->body, "dop853", 1, exact->tolerance);
  double worst = 0;
  for (double t = 0.01; t < 1.5; t += 0.01) {
    while (simulation.time() < t) simulation.step_up_to(t);
    worst = std::max(worst, (session.recording().at(t).q - simulation.state().q).norm());
  }
  CHECK(worst < 5e-3);
}

TEST_CASE("the estimated error of a run agrees with its true error") {
  const NewFolder folder;
  Progress silent;
  auto check_error = [&](const std::string& name, Scene& scene) {
    RunOptions options;
    options.folder = folder / name;
    Run session(scene, options, silent);
    REQUIRE(session.simulate());
    const ErrorEstimate error = session.estimate_error();
    auto exact = free_top();
    Simulation simulation(exact->body, "dop853", 1, 1e-12);
    double worst = 0;
    for (std::int64_t row = 1; row < session.recording().rows(); ++row) {
      const State state = session.recording().state(row);
      while (simulation.time() < state.time()) simulation.step_up_to(state.time());
      worst = std::max(worst, 2 * (state.q - simulation.state().q).segment<4>(3).norm());
    }
    CAPTURE(name, error.rotation, worst);
    CHECK(error.rotation > 0.5 * worst);
    CHECK(error.rotation < 2 * worst);
    CHECK(record_of(folder / name).at("error_estimate").at("rotation") == error.rotation);
  };
  auto controlled = free_top(), fixed = free_top();
  controlled->tolerance = 1e-7;
  controlled->integrator = "dormand_prince";
  check_error("tolerance", *controlled);
  fixed->integrator = "rk4";
  fixed->step = 0.01;
  check_error("step", *fixed);
}

TEST_CASE("the error estimate covers joint forces and gaps, and contact by steps of half the length") {
  const NewFolder folder;
  Progress silent;
  auto scene_of = [](const char* name) {
    auto scene = std::make_unique<Scene>();
    scene->name = name;
    scene->end = 0.5;
    scene->frame_rate = 20;
    scene->appearance.resize(1);
    return scene;
  };
  auto estimate = [&](Scene& scene) {
    RunOptions options;
    options.folder = folder / scene.name;
    Run session(scene, options, silent);
    REQUIRE(session.simulate());
    return session.estimate_error();
  };
  // The joint force of a pendulum is compared with that of a far more accurate simulation.
  auto add_pendulum = [](MultiBody& body) {
    Part& bob = body.add(make_part("bob", "sphere", {}, 1000));
    bob.rest({{"r", 0.1}}).place({0.5, 0, 0});
    body.ball("pivot", world(0, 0, 0), point(bob, 0, kPi));
    bob.place({0.1, 0, 0});
  };
  auto pendulum = scene_of("pendulum");
  add_pendulum(pendulum->body);
  pendulum->integrator = "rk4";
  pendulum->step = 0.02;
  const ErrorEstimate joint_estimate = estimate(*pendulum);
  MultiBody exact_body;
  add_pendulum(exact_body);
  Simulation exact(exact_body, "dop853", 1, 1e-12), coarse(pendulum->body, "rk4");
  Workspace<double> exact_work, coarse_work;
  double worst = 0;
  for (int i = 1; i <= 25; ++i) {
    coarse.step(0.02);
    while (exact.time() < coarse.time()) exact.step_up_to(coarse.time());
    exact.dynamics().ledger(exact.state(), exact_work);
    coarse.dynamics().ledger(coarse.state(), coarse_work);
    worst = std::max(worst, (exact.dynamics().joint_wrench(exact.time(), 0, exact_work).force -
                             coarse.dynamics().joint_wrench(coarse.time(), 0, coarse_work).force)
                                .norm());
  }
  CAPTURE(worst, joint_estimate.joint_force, joint_estimate.gap);
  CHECK(joint_estimate.joint_force > 0.3 * worst);
  CHECK(joint_estimate.joint_force < 2 * worst);
  CHECK(joint_estimate.joint_torque == 0);
  CHECK(joint_estimate.gap < 1e-14);
  CHECK(record_of(folder / "pendulum").at("error_estimate").at("joint_force") == joint_estimate.joint_force);

  // A box that slides and spins to a stop, with error control. estimate_error() repeats the run with contact
  // steps of half the length, and then restores the setting longest_step of the scene.
  auto box = scene_of("box");
  box->tolerance = 1e-6;
  box->integrator = "dop853";
  Part& part = box->body.add(make_part("box", "box", {}, 1000));
  part.rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.1}}).place({0, 0, 0.1}).velocity({1, 0, 0}, {0, 0, 5});
  box->body.contact.active = true;
  box->body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  const ErrorEstimate contact_estimate = estimate(*box);
  CHECK(contact_estimate.place > 1e-8);
  CHECK(contact_estimate.place < 1e-3);
  CHECK(box->body.contact.longest_step == 2e-3);
}

TEST_CASE("N30: the frame rate does not change the motion") {
  const NewFolder folder;
  const Model* model = nullptr;
  std::vector<State> last;
  for (const double rate : {1.0, 24.0, 1000.0, 3001.0}) {
    const auto scene = pulled_scene();
    scene->frame_rate = rate;
    const fs::path out = folder / std::to_string(rate);
    REQUIRE(run(*scene, out));
    const Model here(scene->body);
    model = &here;
    const Recording recording(out, *model);
    last.push_back(recording.state(recording.rows() - 1));
    CHECK(last.back().q == last.front().q);
    CHECK(last.back().v == last.front().v);
    CHECK(last.back().step == 200);
  }
}

TEST_CASE("I55: a run resumes only with its original scene, step, method and frame rate") {
  const NewFolder folder;
  run(*pulled_scene(), folder / "r", {Existing::refuse, 1, 50});
  const std::string before = results_of(folder / "r");
  const auto refused = [&](void (*change)(Scene&)) {
    const auto scene = pulled_scene();
    change(*scene);
    CHECK_THROWS_AS(run(*scene, folder / "r", {Existing::resume}), RecordingMismatch);
  };
  refused([](Scene& s) { s.hash = 1; });
  refused([](Scene& s) { s.step = 2e-3; });
  refused([](Scene& s) { s.frame_rate = 25; });
  refused([](Scene& s) { s.integrator = "semi_implicit_euler"; });
  std::string record = bytes_of(folder / "r" / kRunFile);
  record.replace(record.find("\"compiler\": \""), 13, "\"compiler\": \"x");
  set_bytes(folder / "r" / kRunFile, record);
  CHECK_THROWS_AS(run(*pulled_scene(), folder / "r", {Existing::resume}), RecordingMismatch);
  CHECK(results_of(folder / "r") == before);
}

TEST_CASE("I49: a folder that is not empty is refused; force removes only the files of a run") {
  const NewFolder folder;
  const fs::path out = folder / "r";
  REQUIRE(run(*pulled_scene(), out));
  const std::string first = results_of(out);
  CHECK_THROWS_AS(run(*free_top(), out), OutputRefused);
  CHECK(results_of(out) == first);
  set_bytes(out / "notes.txt", "mine");
  fs::create_directory(out / kMeshFolder);
  fs::create_directory(out / kFrameFolder);
  for (const char* file :
       {"meshes/frame_000001.obj", "meshes/frame_000001.ply", "meshes/parts.mtl", "frames/frame_000001.png",
        "frames/frame_000002.png.part-12-0", "frames/cat.png", "frames/frame_1.png"})
    set_bytes(out / file, "x");
  REQUIRE(run(*free_top(), out, {Existing::force}));
  CHECK(bytes_of(out / "notes.txt") == "mine");
  CHECK_FALSE(fs::exists(out / kMeshFolder));
  CHECK(fs::exists(out / "frames/cat.png"));
  CHECK(fs::exists(out / "frames/frame_1.png"));
  CHECK(std::distance(fs::directory_iterator(out / kFrameFolder), fs::directory_iterator()) == 2);
  CHECK(record_of(out).at("scene").at("name") == "top");

  fs::create_directory(folder / "home");
  set_bytes(folder / "home" / "letter.txt", "dear");
  CHECK_THROWS_AS(run(*free_top(), folder / "home", {Existing::force}), OutputRefused);
  CHECK_THROWS_AS(run(*free_top(), folder / "home", {Existing::resume}), OutputRefused);
  CHECK_THROWS_AS(run(*free_top(), folder / "absent", {Existing::resume}), OutputRefused);
  CHECK_FALSE(fs::exists(folder / "absent"));
}

TEST_CASE("I50: files, links and the folder of the scene are never overwritten") {
  const NewFolder folder;
  set_bytes(folder / "file", "x");
  CHECK_THROWS_AS(run(*free_top(), folder / "file", {Existing::force}), OutputRefused);
  fs::create_directory(folder / "real");
  fs::create_directory_symlink(folder / "real", folder / "link");
  CHECK_THROWS_AS(run(*free_top(), folder / "link"), OutputRefused);
  CHECK(fs::is_empty(folder / "real"));

  REQUIRE(run(*free_top(), folder / "r"));
  set_bytes(folder / "r" / kSceneFile, "{}");
  CHECK_THROWS_AS(RunFolder(folder / "r", Existing::force, folder / "r" / kSceneFile), OutputRefused);
  CHECK(bytes_of(folder / "r" / kSceneFile) == "{}");
  CHECK_THROWS_AS(make_subfolder(folder / "file"), OutputRefused);
  CHECK_THROWS_AS(make_subfolder(folder / "link"), OutputRefused);
}

TEST_CASE("I58: two runs never share a folder") {
  const NewFolder folder;
  {
    const RunFolder held(folder / "r", Existing::refuse);
    CHECK(bytes_of(folder / "r" / kLockFile) == std::to_string(::getpid()));
    CHECK_THROWS_AS(RunFolder(folder / "r", Existing::refuse), OutputRefused);
    set_bytes(folder / "r" / kRunFile, "{}");
    CHECK_THROWS_AS(RunFolder(folder / "r", Existing::force), OutputRefused);
    CHECK_THROWS_AS(RunFolder(folder / "r", Existing::resume), OutputRefused);
  }
  CHECK_FALSE(fs::exists(folder / "r" / kLockFile));
  set_bytes(folder / "r" / kLockFile, "12345");  // a process that was killed leaves its lock file
  CHECK_NOTHROW(RunFolder(folder / "r", Existing::force));
}

TEST_CASE("a motion that diverges ends with its last good state in the recording") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  scene->step = 0.5;
  scene->end = 500;
  CHECK_THROWS_AS(run(*scene, folder / "r"), NumericalFailure);
  const nlohmann::json record = record_of(folder / "r");
  CHECK(record.at("status") == "failed");
  CHECK(record.at("message").get<std::string>().find("not a finite number") != std::string::npos);
  CHECK(record.at("notes").dump().find("largest stable") != std::string::npos);
  const Model model(scene->body);
  const Recording recording(folder / "r", model);
  const State last = recording.state(recording.rows() - 1);
  CHECK(last.q.allFinite());
  CHECK(last.time() == record.at("progress").at("time"));
  const std::string table = bytes_of(folder / "r" / kTrajectoryFile);
  CHECK(table.find("nan") == std::string::npos);
  CHECK(table.find("inf") == std::string::npos);
}

TEST_CASE("a bad scene is refused before a folder is created") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  scene->integrator = "rk5";
  CHECK_THROWS_AS(run(*scene, folder / "r"), std::invalid_argument);
  const auto looks = pulled_scene();
  looks->appearance.clear();
  CHECK_THROWS_AS(run(*looks, folder / "r"), std::invalid_argument);
  CHECK_FALSE(fs::exists(folder / "r"));
}

TEST_CASE("a run by a method of first order states its error") {
  const NewFolder folder;
  const auto notes_of = [&](const char* name, const char* integrator, double step) {
    const auto scene = pulled_scene();
    scene->integrator = integrator;
    scene->step = step;
    REQUIRE(run(*scene, folder / name));
    const auto notes = record_of(folder / name).at("notes");
    return std::count_if(notes.begin(), notes.end(), [](const auto& note) {
      return note.template get<std::string>().find("The method semi_implicit_euler is of order 1.") !=
             std::string::npos;
    });
  };
  CHECK(notes_of("first", "semi_implicit_euler", 1e-3) == 1);
  CHECK(notes_of("fourth", "rk4", 1e-3) == 0);
}

TEST_CASE("I59: runs without parts, or without duration, are valid") {
  const NewFolder folder;
  Scene empty;
  REQUIRE(run(empty, folder / "empty"));
  CHECK(record_of(folder / "empty").at("progress").at("states") == 26);
  const auto still = free_top();
  still->end = 0;
  REQUIRE(run(*still, folder / "still"));
  CHECK(record_of(folder / "still").at("progress").at("states") == 1);
}

TEST_CASE("run.json reports steps, evaluations, skipped computations and files") {
  const NewFolder folder;
  const auto scene = free_top();
  scene->end = 0.335;
  REQUIRE(run(*scene, folder / "r"));
  const RunRecord record = read_run_record(folder / "r" / kRunFile);
  CHECK(record.status == RunRecord::Status::complete);
  CHECK(record.steps == 34);
  CHECK(record.step == 0.335 / 34);
  CHECK(record.requested_step == 0.01);
  CHECK(record.time == 0.335 / 34 * 34);
  CHECK(record.notes.size() == 1);
  CHECK(record.work.steps.evaluations == 4 * 34);
  CHECK(record.work.parts.jacobian_points == 0);
  CHECK(record.work.parts.rate_points == 0);
  CHECK(record.work.parts.surfaces == 0);
  CHECK_FALSE(record.skipped.empty());
  CHECK(record.stable_step ==
        Approx(0.5 / std::sqrt(5.01)));  // in this time the top rotates by 0.5 rad; nothing is stiff
  for (const std::string& file : record.files) CHECK(fs::exists(folder / "r" / file));
  CHECK_FALSE(fs::exists(folder / "r" / kLockFile));
}

TEST_CASE("run.json reports once which part rotates too far for elasticity that is linear in d") {
  const NewFolder folder;
  auto notes = [&](const char* name, const char* law, double twist) {
    const auto scene = free_top();
    scene->end = 0.01;
    scene->appearance.emplace_back();
    Part& tube = scene->body.add(make_part("tube", "cylinder", {"twist"}, 1));
    tube.make_shell().initial({{"twist.angle", twist}}).stiffness({{"twist.angle", 1}});
    LocalSettings settings;
    settings.resolution = 2;
    if (std::string(law) == "loaded_membrane")
      settings.energies = {local_law(law, {1, 1})};
    else
      settings.energies = {local_law(law, {1e3, 0.3, 0.01})};
    tube.deform_locally(settings);
    REQUIRE(run(*scene, folder / name));
    const RunRecord record = read_run_record(folder / name / kRunFile);
    return std::count_if(record.notes.begin(), record.notes.end(), [](const std::string& note) {
      return note.find("the parameters of part 'tube' rotate some of its surface by") != std::string::npos;
    });
  };
  CHECK(notes("far", "membrane", 0.8) == 1);
  CHECK(notes("near", "membrane", 0.2) == 0);
  CHECK(notes("whole", "neo_hookean_membrane", 0.8) == 0);
  CHECK(notes("alike", "loaded_membrane", 0.8) == 0);
}

TEST_CASE("run.json reports once which joint rows are redundant, and which joints stay open") {
  const NewFolder folder;
  auto notes_of = [&](const char* name, const std::function<void(MultiBody&, Part&)>& join) {
    const auto scene = free_top();
    scene->end = 0.4;
    join(scene->body, *scene->body.parts().front());
    REQUIRE(run(*scene, folder / name));
    return read_run_record(folder / name / kRunFile);
  };
  auto count = [](const RunRecord& record, const std::string& text) {
    return std::count_if(record.notes.begin(), record.notes.end(),
                         [&](const std::string& note) { return note.find(text) != std::string::npos; });
  };
  SECTION("a doubled joint") {
    const RunRecord record = notes_of("twice", [](MultiBody& body, Part& top) {
      const Point at = point(top, 0, 0, 0);
      for (const char* name : {"once", "again"})
        body.ball(name, world(top.c0()[0], top.c0()[1], top.c0()[2]), at);
    });
    CHECK(count(record,
                "redundant constraints, implied by those of other joints: 3 rows of 1 joint, 'once'") == 1);
    CHECK(count(record, "redundant") == 1);
    CHECK(record.open_gap == 0);
  }
  SECTION("a doubled joint that switches on later") {
    const RunRecord record = notes_of("later", [](MultiBody& body, Part& top) {
      const Point at = point(top, 0, 0, 0);
      body.ball("once", world(top.c0()[0], top.c0()[1], top.c0()[2]), at);
      body.ball("again", world(top.c0()[0], top.c0()[1], top.c0()[2]), at).during(0.2);
    });
    CHECK(count(record, "redundant constraints, implied by those of other joints: 3 rows of 1 joint") == 1);
  }
  SECTION("a point at two places") {
    const RunRecord record = notes_of("apart", [](MultiBody& body, Part& top) {
      const Point at = point(top, 0, 0, 0);
      body.ball("here", world(top.c0()[0], top.c0()[1], top.c0()[2]), at);
      body.ball("there", world(top.c0()[0] + 1, top.c0()[1], top.c0()[2]), at);
    });
    CHECK(count(record, "may never close: 3 rows of 1 joint, 'there'") == 1);
    CHECK(count(record, "redundant") == 0);
    CHECK(count(record, "at t = 0.4 s 1 joint is still open: ball 'there', by 1 m") == 1);
    CHECK(record.open_gap == Approx(1));
    CHECK(record.max_gap <= 1e-12);
  }
  SECTION("a joint that switches on at a moving part") {
    const RunRecord record = notes_of("hold", [](MultiBody& body, Part& top) {
      body.gravity.setZero();
      top.velocity({0.5, 0, 0}, {0, 0, 0});
      body.ball("hook", world(top.c0()[0] + 0.1, top.c0()[1], top.c0()[2]), point(top, 0, 0, 0)).during(0.2);
    });
    CHECK(count(record, "at t = 0.2 s ball 'hook' engages with an impulse of ") == 1);
    CHECK(count(record, "engages") == 1);
  }
  SECTION("a joint that stops a spin, and a second joint that has no impulse") {
    const RunRecord record = notes_of("spin", [](MultiBody& body, Part& top) {
      body.gravity.setZero();
      top.velocity({0, 0, 0}, {0, 0, 5});
      top.prepare();
      const Point centre = world(top.c0()[0], top.c0()[1], top.c0()[2]);
      body.ball("pivot", point(top, 0, 0, 0), centre).during(0.2);
      JointSetting setting{point(top, 0, 0, 0), centre};
      setting.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(1, Vec3<double>::UnitZ()));
      body.join("weld", "stop", setting).during(0.2);
    });
    CHECK(count(record, "at t = 0.2 s weld 'stop' engages with an impulse of ") == 1);
    CHECK(count(record, " N m s") == 1);
    CHECK(count(record, " N s") == 0);
    CHECK(count(record, "the largest of") == 0);
  }
  SECTION("a path whose rate jumps repeatedly") {
    const RunRecord record = notes_of("path", [](MultiBody& body, Part& top) {
      const Vec3<double> c = top.c0();
      body.ball(
          "hand", point(top, 0, 0, 0),
          world({c[0], c[1], TimeFunction::formula(std::to_string(c[2]) + " + 0.1 * abs(sin(30 * t))")}));
    });
    CHECK(count(record, "the velocity of a prescribed path jumps: ball 'hand' follows with an impulse of ") ==
          1);
    CHECK(record.max_balance_error <= 1e-2);
  }
  SECTION("a string that closes against gravity") {
    const RunRecord record = notes_of("string", [](MultiBody& body, Part& top) {
      body.gravity = {0, 0, -9.81};
      top.velocity({0, 0, 0}, {0, 0, 0});
      const Vec3<double> above = top.c0() + Vec3<double>(0, 0, 0.901);
      body.join("string", String{0.9}, {world(TimeVector(above)), point(top, 0, 0, 0)});
    });
    CHECK(count(record, "may never close") == 0);
    CHECK(count(record, "still open") == 0);
  }
  SECTION("without projection, a joint with a small gap is not reported as open") {
    const RunRecord record = notes_of("unprojected", [](MultiBody& body, Part& top) {
      body.stabilization.projection = false;
      body.gravity = {0, 0, -9.81};
      top.velocity({0, 0, 0}, {0, 0, 0});
      const Vec3<double> at = top.c0() + top.R0() * Vec3<double>(0.3, 0, 0);
      body.ball("pivot", point(top, 0, 0), world(TimeVector(at)));
    });
    CHECK(count(record, "still open") == 0);
    CHECK(record.max_gap > 0);
    CHECK(record.open_gap == 0);
  }
  SECTION("a rod without direction") {
    const RunRecord record = notes_of("rod", [](MultiBody& body, Part& top) {
      body.join("rod", Rod{0.5}, {world(top.c0()[0], top.c0()[1], top.c0()[2]), point(top, 0, 0, 0)});
    });
    CHECK(count(record, "without direction at the present positions: 1 row of 1 joint, 'rod'") == 1);
    CHECK(count(record, "redundant") == 0);
  }
}

TEST_CASE("redundant rows are reported once, also when other joints switch") {
  struct Listener : Progress {
    int redundant_notes = 0;
    void note(const std::string& text) override {
      if (text.find("redundant") != std::string::npos) ++redundant_notes;
    }
  };
  const NewFolder folder;
  const auto scene = free_top();
  scene->end = 0.4;
  Part& top = *scene->body.parts().front();
  const Vec3<double> c = top.c0();
  for (const char* name : {"once", "again"})
    scene->body.ball(name, point(top, 0, 0, 0), world(TimeVector(c)));
  for (const double on : {0.1, 0.2, 0.3})
    scene->body
        .join("tether at " + std::to_string(on), String{5}, {point(top, 0, 0, 0), world(TimeVector(c))})
        .during(on, on + 0.05);
  Listener listener;
  RunOptions options;
  options.folder = (folder / "r").string();
  Run(*scene, options, listener).simulate();
  CHECK(listener.redundant_notes == 1);
}

}  // namespace run_test
