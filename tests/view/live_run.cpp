// A simulation in its own thread: pause, single steps, speed, commands and failures.
#include <pliant/view/live_run.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <thread>

#include <pliant/io/frame_meshes.h>
#include <pliant/scene/read_scene.h>

#include "catch.h"

namespace live_run_test {

using namespace pliant;

namespace {

std::unique_ptr<Scene> ball_scene() {
  Diagnostics diagnostics;
  return parse_scene("scene", R"({"gravity": [0, 0, -1], "time": {"step": 0.001, "integrator": "rk4"},
    "parts": [{"name": "ball", "shape": "sphere"}]})",
                     {}, diagnostics);
}

/// Waits until a snapshot satisfies a condition, at most 20 s of wall time. Returns the snapshot.
template <class Condition>
std::shared_ptr<const Snapshot> wait_until(const LiveRun& run, Condition&& holds) {
  for (int i = 0; i < 2000 && !holds(*run.snapshot()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  REQUIRE(holds(*run.snapshot()));
  return run.snapshot();
}

}  // namespace

TEST_CASE("a live run plays, pauses, makes single steps and resets") {
  const std::unique_ptr<Scene> scene = ball_scene();
  LiveRun run(*scene);
  CHECK(run.snapshot()->state.time() == 0);
  CHECK_FALSE(run.snapshot()->running);
  run.step_once();
  wait_until(run, [](const Snapshot& now) { return now.state.time() > 0; });
  CHECK(run.snapshot()->state.time() == Approx(0.017));  // 17 steps are nearest to 1/60 s
  run.play();
  wait_until(run, [](const Snapshot& now) { return now.state.time() > 0.1; });
  run.pause();
  wait_until(run, [](const Snapshot& now) { return !now.running; });
  const double paused = run.snapshot()->state.time();
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  CHECK(run.snapshot()->state.time() == paused);
  run.reset();
  wait_until(run, [](const Snapshot& now) { return now.state.time() == 0; });
}

TEST_CASE("a live run samples its tracks at time 0 and about every 1/60 s, and again after a reset") {
  Diagnostics diagnostics;
  const std::unique_ptr<Scene> scene =
      parse_scene("scene", R"({"gravity": [0, 0, -1], "time": {"step": 0.001, "integrator": "rk4"},
    "parts": [{"name": "ball", "shape": "sphere"}],
    "tracks": [{"part": "ball", "at": {"u": 0, "v": 0, "w": 0}}]})",
                  {}, diagnostics);
  LiveRun run(*scene);
  for (int i = 0; i < 3; ++i) run.step_once();
  wait_until(run, [](const Snapshot& now) { return now.state.time() > 0.05; });
  const std::vector<TrackSample> samples = run.take_track_samples();
  REQUIRE(samples.size() == 4);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    CHECK(samples[i].time == Approx(0.017 * static_cast<double>(i)));
    REQUIRE(samples[i].points.size() == 1);
    CHECK(samples[i].points[0].z() == Approx(-0.5 * samples[i].time * samples[i].time).margin(1e-12));
  }
  CHECK(run.take_track_samples().empty());
  run.reset();
  wait_until(run, [](const Snapshot& now) { return now.state.time() == 0; });
  const std::vector<TrackSample> again = run.take_track_samples();
  REQUIRE(again.size() == 1);
  CHECK(again[0].time == 0);
}

TEST_CASE("a live run keeps real time, or runs as fast as possible") {
  const std::unique_ptr<Scene> scene = ball_scene();
  LiveRun run(*scene);
  run.play();
  const auto start = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(run.snapshot()->speed < 1.5);
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  const std::shared_ptr<const Snapshot> now = run.snapshot();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CHECK(now->state.time() <= wall + 0.05);  // the run is never ahead; other processes may delay it
  CHECK(now->state.time() > 0.2 * wall);
  run.set_max_speed(std::numeric_limits<double>::infinity());
  wait_until(run, [](const Snapshot& later) { return later.state.time() > 10; });
}

TEST_CASE("a live run that is late reports its delay, and catches up at most a second") {
  const std::unique_ptr<Scene> scene = ball_scene();
  std::atomic<bool> slow = true;
  scene->body.force("slow", point(*scene->body.find("ball"), 0, 0),
                    [&](double, const Vec3<double>&, const Vec3<double>&) {
                      if (slow) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                      return Vec3<double>::Zero().eval();
                    });
  LiveRun run(*scene);
  CHECK(run.snapshot()->delay == 0);
  run.play();
  wait_until(run, [](const Snapshot& now) { return now.delay > 0.5; });
  run.pause();
  CHECK(wait_until(run, [](const Snapshot& now) { return !now.running; })->delay == 0);
  run.play();
  wait_until(run, [](const Snapshot& now) { return now.delay > 0.99; });
  std::this_thread::sleep_for(std::chrono::seconds(1));
  CHECK(run.snapshot()->delay <= 1.01);
  slow = false;
  const double before = run.snapshot()->state.time();
  const auto start = std::chrono::steady_clock::now();
  const double after =
      wait_until(run, [](const Snapshot& now) { return now.running && now.delay < 0.01; })->state.time();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CHECK(after - before > wall + 0.8);
  run.set_max_speed(std::numeric_limits<double>::infinity());
  wait_until(run, [](const Snapshot& now) { return now.running && now.delay == 0; });
}

TEST_CASE("a live run does not catch up the time of a slow command") {
  const std::unique_ptr<Scene> scene = ball_scene();
  LiveRun run(*scene);
  run.play();
  const double before = wait_until(run, [](const Snapshot& s) { return s.state.time() > 0.1; })->state.time();
  const auto start = std::chrono::steady_clock::now();
  run.wait_for([](LiveSimulation&) { std::this_thread::sleep_for(std::chrono::milliseconds(500)); });
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CHECK(run.snapshot()->state.time() - before < wall - 0.3);  // 0.2 s for delays by other processes
}

TEST_CASE("a snapshot has the drag, the ledger of the simulation, and the message of a command that fails") {
  const std::unique_ptr<Scene> scene = ball_scene();
  LiveRun run(*scene);
  const Part& ball = *scene->body.find("ball");
  run.post([&](LiveSimulation& live) { live.grab(point(ball, 0, 0), 1000, 10); });
  run.post([](LiveSimulation& live) { live.drag_to({2, 0, 0}); });
  run.play();
  const auto now = wait_until(run, [](const Snapshot& s) { return s.dragging && s.state.time() > 0.5; });
  CHECK(now->target == Vec3<double>(2, 0, 0));
  CHECK(now->held.x() > 1);
  CHECK(now->ledger.work[static_cast<int>(Work::anchors)] > 0);
  run.post([](LiveSimulation& live) { live.release(); });
  wait_until(run, [](const Snapshot& s) { return !s.dragging; });
  run.post([](LiveSimulation&) { throw std::runtime_error("no"); });
  CHECK(wait_until(run, [](const Snapshot& s) { return !s.refusal.empty(); })->refusal == "no");
  CHECK_THROWS_WITH(run.wait_for([](LiveSimulation&) { throw std::runtime_error("never"); }), "never");
}

TEST_CASE("a step that fails stops a live run, and a reset starts it again") {
  Diagnostics diagnostics;
  const auto scene = parse_scene("scene", R"json({"gravity": [0, 0, "1 / max(0.1 - t, 0)"],
    "time": {"step": 0.01, "end": 0.05}, "parts": [{"name": "ball", "shape": "sphere"}]})json",
                                 {}, diagnostics);
  LiveRun run(*scene);
  run.play();
  wait_until(run, [](const Snapshot& now) { return !now.failure.empty() && !now.running; });
  run.reset();
  wait_until(run, [](const Snapshot& now) { return now.failure.empty() && now.state.time() == 0; });
}

TEST_CASE("meshes of a part are made while another thread adds keys to its rest value") {
  Diagnostics diagnostics;
  const std::unique_ptr<Scene> scene = parse_scene("scene", R"({"time": {"step": 0.001},
    "parts": [{"name": "ball", "shape": "ellipsoid", "parameters": {"a1": {"rest": 2, "stiffness": 1}}}]})",
                                                   {}, diagnostics);
  const auto path = std::make_shared<LinearKeys>(std::vector<double>{0}, std::vector<double>{2});
  scene->body.parts().front()->rest("a1", TimeFunction(path));
  scene->coloring = Coloring{};
  const Model model(scene->body);
  std::thread other([&path] {
    for (int i = 1; i <= 100000; ++i) path->append(i, 2.0 + i);
  });
  std::vector<double> rests;
  for (int i = 0; i < 20; ++i) {
    const FrameMeshes meshes(*scene, model);
    rests.push_back(model.parts().front().part->parameters().rest().b[0]);
  }
  other.join();
  CHECK(rests == std::vector<double>(20, 2));
}

}  // namespace live_run_test
