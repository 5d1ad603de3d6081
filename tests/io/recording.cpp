// Recordings: states are read back to the last bit, damage is detected, and states between steps are
// accurate.
// I53, I55 and I59 in names of tests are rows of the table in tests/README.md.
#include <pliant/io/layout.h>
#include <pliant/io/recording.h>

#include <cmath>
#include <limits>
#include <memory>

#include "catch.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/io/run/run_files.h>
#include <pliant/io/state_row.h>
#include <pliant/part/primitive.h>
#include <pliant/shape/box.h>
#include <pliant/shape/ellipsoid.h>
#include <pliant/shape/sphere.h>
#include <pliant/simulate/simulation.h>

namespace recording_test {

using namespace pliant;
namespace fs = std::filesystem;

namespace {

bool bit_equal(const State& a, const State& b) {
  return a.start == b.start && a.h == b.h && a.step == b.step && a.q == b.q && a.v == b.v &&
         a.work == b.work && a.at_limit == b.at_limit;
}

// Performs `steps` steps. Records the initial state and the state after every `stride`-th step, and returns
// the recorded states.
std::vector<State> record(const fs::path& folder, Scene& scene, int steps, int stride) {
  Simulation simulation(scene.body, scene.integrator);
  write_layout(folder, simulation.model(), FrameSchedule(scene.end, scene.step, scene.frame_rate), {});
  RecordingWriter writer = RecordingWriter::create(folder, simulation.model());
  std::vector<State> states;
  for (int i = 0; i <= steps; ++i) {
    if (i > 0) simulation.step(scene.step);
    if (i % stride != 0) continue;
    writer.append(simulation.state(), RunWork());
    states.push_back(simulation.state());
  }
  writer.flush();
  CHECK(writer.rows() == static_cast<std::int64_t>(states.size()));
  return states;
}

}  // namespace

TEST_CASE("recorded states are read back to the last bit, with limits and works") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  const std::vector<State> states = record(folder.path, *scene, 60, 3);
  const Model model(scene->body);
  const Recording recording(folder.path, model);
  REQUIRE(recording.rows() == static_cast<std::int64_t>(states.size()));
  bool limited = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    CHECK(bit_equal(recording.state(static_cast<std::int64_t>(i)), states[i]));
    for (const std::int8_t at : states[i].at_limit) limited = limited || at != 0;
  }
  CHECK(limited);
  CHECK(states.back().work.cwiseAbs().maxCoeff() > 0);
}

TEST_CASE("states with sleeping parts are read back to the last bit") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  scene->body.plane("floor", Vec3<double>(0, 0, -5), {0, 0, 1});
  scene->body.contact.sleep = Sleep{1e-3, 0.02};
  Part& stone = scene->body.add(make_part("stone", "box", {}, 1000));
  stone.place({5, 5, -4});
  const std::vector<State> states = record(folder.path, *scene, 60, 3);
  const Model model(scene->body);
  const Recording recording(folder.path, model);
  REQUIRE(recording.rows() == static_cast<std::int64_t>(states.size()));
  bool awake = false, asleep = false;
  for (std::size_t i = 0; i < states.size(); ++i) {
    CHECK(hash(recording.state(static_cast<std::int64_t>(i))) == hash(states[i]));
    awake = awake || states[i].at_rest.back() > 0;
    asleep = asleep || states[i].at_rest.back() < 0;
  }
  CHECK(awake);
  CHECK(asleep);
}

namespace {

/// Returns pulled_scene() with contact, a floor and two more boxes. The box "below" stands on the floor, and
/// the box "above" stands on "below".
std::unique_ptr<Scene> standing_scene() {
  auto scene = pulled_scene();
  scene->body.contact.active = true;
  scene->body.plane("floor", Vec3<double>(0, 0, -5), {0, 0, 1});
  for (const double z : {-4.5, -3.5})
    scene->body.add(make_part(z < -4 ? "below" : "above", "box", {}, 1000))
        .rest({{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.5}})
        .place({5, 5, z});
  return scene;
}

}  // namespace

TEST_CASE("recorded contact caches are read back, and damage in them is detected") {
  const NewFolder folder;
  const auto scene = standing_scene();
  const std::vector<State> states = record(folder.path, *scene, 12, 3);
  const Model model(scene->body);
  const std::string whole = bytes_of(folder / kContactCacheFile);
  {
    const Recording recording(folder.path, model);
    REQUIRE(recording.rows() == static_cast<std::int64_t>(states.size()));
    for (std::size_t i = 0; i < states.size(); ++i)
      CHECK(hash(recording.state(static_cast<std::int64_t>(i))) == hash(states[i]));
    CHECK(states.back().contact_cache.size() > 4);
  }
  // If the cache of the last state is truncated, the recording has one state fewer. If this state is recorded
  // again, the file is identical to the original file.
  set_bytes(folder / kContactCacheFile, whole.substr(0, whole.size() - 8));
  const auto rows = static_cast<std::int64_t>(states.size() - 1);
  CHECK(Recording(folder.path, model).rows() == rows);
  RecordingWriter writer = RecordingWriter::resume(folder.path, model, rows);
  writer.append(states.back(), RunWork());
  writer.flush();
  CHECK(bytes_of(folder / kContactCacheFile) == whole);
  CHECK(hash(Recording(folder.path, model).state(rows)) == hash(states.back()));
  // Distances of three bytes from the end of the file. The first byte is in the force of the last contact,
  // the second in the index of its part a, and the third in the force of the contact before it. All three
  // bytes belong to the last state.
  for (const std::size_t from_end : {5, 75, 85}) {
    std::string bytes = whole;
    bytes[bytes.size() - from_end] = static_cast<char>(bytes[bytes.size() - from_end] ^ 0x40);
    set_bytes(folder / kContactCacheFile, bytes);
    CHECK_THROWS_AS(Recording(folder.path, model).state(rows), RecordingMismatch);
    CHECK_NOTHROW(Recording(folder.path, model).state(0));
  }
  set_bytes(folder / kContactCacheFile, whole);
  // Three columns of modes.npy give the first and last rows of a state in the contact cache, and the age of
  // the cache. A flipped bit in these columns of state 2 is detected, and states 1 and 3 remain readable.
  const std::string modes = bytes_of(folder / kModesFile);
  const std::size_t row = (modes.size() - 128) / states.size();
  for (std::size_t byte = 128 + 2 * row + 8 * kFirstCachedContact;
       byte < 128 + 2 * row + 8 * (kEndOfCachedContacts + 2); ++byte) {
    std::string bytes = modes;
    bytes[byte] = static_cast<char>(bytes[byte] ^ 0x10);
    set_bytes(folder / kModesFile, bytes);
    CAPTURE(byte);
    const Recording recording(folder.path, model);
    CHECK_THROWS_AS(recording.state(2), RecordingMismatch);
    CHECK(hash(recording.state(1)) == hash(states[1]));
    CHECK(hash(recording.state(3)) == hash(states[3]));
  }
}

TEST_CASE("I53: after a kill the shortest table determines the number of states") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  const std::vector<State> states = record(folder.path, *scene, 20, 2);
  const Model model(scene->body);
  std::int64_t rows = static_cast<std::int64_t>(states.size());
  for (const char* table : {kVelocitiesFile, kTimesFile, kModesFile, kCoordinatesFile}) {
    const std::string bytes = bytes_of(folder / table);
    const std::size_t row = (bytes.size() - 128) / states.size();
    --rows;
    set_bytes(folder / table, bytes.substr(0, 128 + row * static_cast<std::size_t>(rows) + 5));
    const Recording recording(folder.path, model);
    REQUIRE(recording.rows() == rows);
    CHECK(bit_equal(recording.state(rows - 1), states[static_cast<std::size_t>(rows - 1)]));
  }
  RecordingWriter writer = RecordingWriter::resume(folder.path, model, rows);
  writer.append(states[static_cast<std::size_t>(rows)], RunWork());
  writer.flush();
  CHECK(bit_equal(Recording(folder.path, model).state(rows), states[static_cast<std::size_t>(rows)]));
}

TEST_CASE("I55: one flipped bit is detected") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  record(folder.path, *scene, 4, 1);
  const Model model(scene->body);
  for (const char* table : {kCoordinatesFile, kVelocitiesFile, kModesFile}) {
    const std::string whole = bytes_of(folder / table);
    const std::size_t row = (whole.size() - 128) / 5;
    for (std::size_t byte = 128 + 2 * row; byte < 128 + 3 * row; byte += 11) {
      std::string bytes = whole;
      bytes[byte] = static_cast<char>(bytes[byte] ^ 0x10);
      set_bytes(folder / table, bytes);
      const Recording recording(folder.path, model);
      CHECK_THROWS_AS(recording.state(2), RecordingMismatch);
      CHECK_NOTHROW(recording.state(1));
    }
    set_bytes(folder / table, whole);
  }
}

TEST_CASE("I55: a recording of another scene, or with a damaged layout, is refused") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  record(folder.path, *scene, 4, 1);
  const auto top = free_top();
  const Model other(top->body);
  CHECK_THROWS_AS(Recording(folder.path, other), RecordingMismatch);
  set_bytes(folder / kLayoutFile, "{");
  const Model model(scene->body);
  CHECK_THROWS_AS(Recording(folder.path, model), RecordingMismatch);
}

TEST_CASE("pictures between two steps follow the motion to fourth order") {
  double last = 0;
  for (const double h : {0.04, 0.02}) {
    const NewFolder folder;
    const auto scene = free_top();
    scene->step = h;
    record(folder.path, *scene, static_cast<int>(std::lround(0.4 / h)), 1);
    const Model model(scene->body);
    const Recording recording(folder.path, model);
    // The reference motion has much smaller steps.
    const auto fine = free_top();
    Simulation simulation(fine->body, "rk4");
    double worst = 0;
    for (int i = 1; i <= 400; ++i) {
      simulation.step(0.001);
      const State between = recording.at(0.001 * i);
      worst = std::max(worst, (between.q - simulation.state().q).cwiseAbs().maxCoeff());
      CHECK(std::abs(between.q.segment<4>(3).norm() - 1) < 1e-15);
    }
    if (last > 0) CHECK(last / worst > 11);
    last = worst;
  }
  CHECK(last < 1e-6);
}

TEST_CASE("with error control, pictures between two steps are as accurate as the steps") {
  auto errors = [](const char* method, double tolerance, double stiffness) {
    struct {
      double at_steps = 0, between = 0;
    } worst;
    auto build = [&](MultiBody& body) {
      Part& part = body.add<Primitive<Ellipsoid>>("body");
      part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).velocity({0, 0, 0}, {0.01, 5, 0.01});
      if (stiffness > 0)
        part.stiffness({{"a1", stiffness}, {"a2", stiffness}, {"a3", stiffness}}).damping(0, 1e-3);
      else
        part.freeze({"a1", "a2", "a3"});
      body.ball("joint", world(0.3, 0, 0), point(part, 0, 0));
    };
    const NewFolder folder;
    MultiBody body, fine;
    build(body);
    build(fine);
    Simulation simulation(body, method, 1, tolerance);
    Simulation exact(fine, stiffness > 0 ? "esdirk" : "dop853", 1, stiffness > 0 ? 1e-7 : 1e-12);
    {
      write_layout(folder.path, simulation.model(), FrameSchedule::with_free_steps(2, 50), {});
      RecordingWriter writer = RecordingWriter::create(folder.path, simulation.model());
      for (writer.append(simulation.state(), RunWork()); simulation.time() < 2;
           writer.append(simulation.state(), RunWork()))
        simulation.step_up_to(2);
      writer.flush();
    }
    const Recording recording(folder.path, simulation.model());
    auto error_at = [&](double t) {
      while (exact.time() < t) exact.step_up_to(t);
      const State state = recording.at(t);
      CHECK(state.time() == Approx(t).epsilon(1e-14));
      return (state.q - exact.state().q).norm();
    };
    for (std::int64_t row = 1; row < recording.rows(); ++row) {
      const double from = recording.time(row - 1), to = recording.time(row);
      for (const double x : {0.2, 0.5, 0.8})
        worst.between = std::max(worst.between, error_at(from + x * (to - from)));
      worst.at_steps = std::max(worst.at_steps, error_at(to));
    }
    return worst;
  };
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    CAPTURE(tolerance);
    const auto worst = errors("dop853", tolerance, 0);
    CAPTURE(worst.at_steps, worst.between);
    CHECK(worst.between < 1.5 * worst.at_steps);
  }
  // Explicit steps are too inaccurate for stiff motion, so the recording interpolates its states.
  const auto worst = errors("esdirk", 1e-5, 1e10);
  CAPTURE(worst.at_steps, worst.between);
  CHECK(worst.between < 3 * worst.at_steps);
}

TEST_CASE("pictures between long steps show resting parts at rest, and a rolling ball on its slope") {
  const NewFolder folder;
  MultiBody body;
  body.contact.active = true;
  body.contact.friction = 1;
  body.add<Primitive<Box>>("slope")
      .rest({{"a1", 3}, {"a2", 1}, {"a3", 0.5}})
      .place({0, 0, -0.5 / std::cos(0.3)}, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3<double>::UnitY())))
      .fix();
  const Vec3<double> up(std::sin(0.3), 0, std::cos(0.3)), down(std::cos(0.3), 0, -std::sin(0.3));
  body.add<Primitive<Sphere>>("ball").rest({{"r", 0.2}}).place(0.2 * up);
  body.add<Primitive<Box>>("box")
      .rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.2}})
      .place(-down + 0.2 * up, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3<double>::UnitY())));
  Simulation simulation(body, "dop853", 1, 1e-4);
  {
    write_layout(folder.path, simulation.model(), FrameSchedule::with_free_steps(1, 50), {});
    RecordingWriter writer = RecordingWriter::create(folder.path, simulation.model());
    for (writer.append(simulation.state(), RunWork()); simulation.time() < 1;
         writer.append(simulation.state(), RunWork()))
      simulation.step_up_to(1);
    writer.flush();
  }
  CHECK(simulation.step_counters().steps < 60);
  const Recording recording(folder.path, simulation.model());
  const Vec3<double> box = simulation.model().position(simulation.state(), 2);
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.005 * i;
    const State state = recording.at(t);
    CAPTURE(t);
    CHECK((simulation.model().position(state, 2) - box).norm() < 1e-9);
    const double distance = 0.5 * 5.0 / 7 * 9.81 * std::sin(0.3) * t * t;
    CHECK((simulation.model().position(state, 1) - 0.2 * up - distance * down).norm() < 1e-4);
  }
}

TEST_CASE("a recorded time gives the recorded state itself") {
  const NewFolder folder;
  const auto scene = free_top();
  const std::vector<State> states = record(folder.path, *scene, 30, 10);
  const Model model(scene->body);
  const Recording recording(folder.path, model);
  for (const State& state : states) {
    CHECK(bit_equal(recording.at(state.time()), state));
    CHECK(bit_equal(recording.at(std::nextafter(state.time(), 0)), state));
    CHECK(bit_equal(recording.at(std::nextafter(state.time(), 9)), state));
  }
  CHECK(bit_equal(recording.at(-1), states.front()));
  CHECK(bit_equal(recording.at(99), states.back()));
}

TEST_CASE("I59: a scene without parts records its times") {
  const NewFolder folder;
  Scene scene;
  record(folder.path, scene, 5, 1);
  const Model model(scene.body);
  const Recording recording(folder.path, model);
  CHECK(recording.rows() == 6);
  CHECK(recording.state(5).q.size() == 0);
}

}  // namespace recording_test
