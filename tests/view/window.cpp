// The window on a virtual display: scripts and a real mouse of the display. A dragged point moves as in a
// simulation with the saved spring.
#include <cstdlib>
#include <sstream>

#include <pliant/body/placed_point.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/scheduled_step.h>
#include <pliant/scene/read_scene.h>
#include <pliant/view/viewer.h>

#include "catch.h"
#include "io/new_folder.h"

namespace window_test {

using namespace pliant;

namespace {

const char* const kScene = R"({
  "gravity": [0, 0, 0], "time": {"tolerance": 1e-8},
  "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.4}, "position": [0, 0, 0.5]},
            {"name": "egg", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.5}, "position": [1.5, 0, 0.5]}],
  "camera": {"eye": [0.7, -6, 1.5], "target": [0.7, 0, 0.5]}
})";

const char* const kSpringScene = R"({
  "gravity": [0, 0, 0], "time": {"tolerance": 1e-8},
  "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": {"rest": 0.4, "stiffness": 4000}},
             "position": [0, 0, 0.5]}],
  "springs": [{"name": "band", "from": {"world": [2.5, 0, 0.5]}, "to": {"part": "ball", "at": {"u": 0, "v": 0}},
               "stiffness": 5, "damping": 0.1}],
  "camera": {"eye": [0.7, -6, 1.5], "target": [0.7, 0, 0.5]}
})";

/// Runs a shell command on a virtual display, with `folder` as its working folder. Returns its standard
/// output.
std::string on_display(const NewFolder& folder, const std::string& command) {
  const std::string line =
      "cd '" + folder.path.string() + "' && sh '" PLIANT_ON_DISPLAY "' " + command + " > .out 2> .err";
  INFO(line);
  const int status = std::system(line.c_str());
  INFO(bytes_of(folder / ".err"));
  REQUIRE(status == 0);
  return bytes_of(folder / ".out");
}

std::string viewer(const std::string& arguments) {
  return "'" + std::string(PLIANT_PROGRAM) + "' view " + arguments;
}

/// Returns a shell script that shows scene.json with script.txt, moves the mouse of the display by some
/// commands, and waits for the end. The commands find the window in $window.
std::string with_mouse(const std::string& commands) {
  return viewer("scene.json --script script.txt --out played.json") + R"( &
program=$!
for i in $(seq 100); do
  window=$(xdotool search --name 'pliant: scene' 2>/dev/null | head -n 1) && [ -n "$window" ] && break
  sleep 0.1
done
sleep 2
)" + commands +
         "\nwait $program\n";
}

bool no_display() {
  if (std::string(PLIANT_ON_DISPLAY).empty() || !missing_window_packages().empty()) {
    WARN("skipped: this build has no window, or Xvfb or xdotool is missing");
    return true;
  }
  return false;
}

/// What a script reports of a drag: time, s, and the positions of the held point and of the target, m.
struct Report {
  double time = 0;
  Vec3<double> held = Vec3<double>::Zero(), target = Vec3<double>::Zero();
};
Report last_report(const std::string& printed) {
  const std::size_t line = printed.rfind("time ");
  REQUIRE(line != std::string::npos);
  Report report;
  std::istringstream(printed.substr(line + 5)) >> report.time;
  auto vector_after = [&](const char* word) {
    const std::size_t at = printed.find(word, line);
    REQUIRE(at != std::string::npos);
    Vec3<double> x;
    std::istringstream(printed.substr(at + std::string(word).size())) >> x[0] >> x[1] >> x[2];
    return x;
  };
  report.held = vector_after("held ");
  report.target = vector_after("target ");
  return report;
}

/// Runs a saved scene and returns the position (m) of the point of its last spring at a time (s). Sets `part`
/// to the name of the part of this point.
Vec3<double> replayed_point(const std::filesystem::path& file, double time, std::string& part) {
  Diagnostics diagnostics;
  const std::unique_ptr<Scene> scene = read_scene(file.string(), {}, diagnostics);
  REQUIRE_FALSE(scene->body.springs().empty());
  const Spring& spring = *scene->body.springs().back();
  part = spring.a.part->name();
  Simulation simulation(scene->body, scene->integrator, 1, scene->tolerance);
  while (simulation.time() < time - 1e-9) simulation.step_up_to(time);
  return PlacedPoint(simulation.model(), spring.a).at(simulation.state());
}

}  // namespace

// With sanitizers, libraries of the display leak memory from modules that are already unloaded, so that no
// suppression applies. The tests of the window therefore have the tag [long], and runs with sanitizers
// exclude them.
TEST_CASE("a scripted drag moves the point of a part as the library does with the saved spring", "[long]") {
  if (no_display()) return;
  const NewFolder folder;
  set_bytes(folder / "scene.json", kScene);
  std::string script = "over egg\npress left\npart\nkey space\n";
  for (int i = 0; i < 20; ++i) script += "move " + std::to_string(560 + 5 * i) + " 250\npictures 2\n";
  script +=
      "until 1\nkey space\npictures 5\nreport\nkey w\nrelease left\npictures 2\nphotograph window.png\n";
  set_bytes(folder / "script.txt", script);
  const std::string printed = on_display(folder, viewer("scene.json --script script.txt --out played.json"));
  CHECK(printed.find("part egg\n") != std::string::npos);
  CHECK(std::filesystem::file_size(folder / "window.png") > 10000);
  const Report report = last_report(printed);
  CHECK(report.time >= 1);
  std::string part;
  const Vec3<double> x = replayed_point(folder / "played.json", report.time, part);
  CHECK(part == "egg");
  CHECK((x - report.held).norm() <= 1e-6);
  CHECK((report.held - Vec3<double>(1.5, 0, 0.5)).norm() > 0.3);
}

TEST_CASE("a dragged point answers within two pictures of a movement of the mouse", "[long]") {
  if (no_display()) return;
  const NewFolder folder;
  set_bytes(folder / "scene.json", kScene);
  set_bytes(folder / "script.txt",
            "over egg\npress left\nkey space\npictures 30\nreport\nmove 700 200\npictures 2\nreport\n");
  const std::string printed = on_display(folder, viewer("scene.json --script script.txt"));
  const Report after = last_report(printed), before = last_report(printed.substr(0, printed.rfind("time ")));
  const Vec3<double> way = after.target - before.target;
  CAPTURE(before.held, after.held, before.target, after.target);
  REQUIRE(way.norm() > 0.1);
  CHECK((after.held - before.held).dot(way.normalized()) > 1e-4);
}

TEST_CASE("a recording plays, steps and returns to its start, and shows forces", "[long]") {
  if (no_display()) return;
  const NewFolder folder;
  set_bytes(folder / "scene.json", kSpringScene);
  REQUIRE(std::system(("cd '" + folder.path.string() + "' && '" + PLIANT_PROGRAM +
                       "' run scene.json -o r --end 1 --fps 10 --quiet")
                          .c_str()) == 0);
  set_bytes(
      folder / "script.txt",
      "key s\nkey s\npictures 2\nreport\nphotograph plain.png\nkey f\npictures 2\nphotograph forces.png\n"
      "key r\npictures 2\nreport\nkey space\nuntil 0.5\nreport\n");
  const std::string printed = on_display(folder, viewer("r --script script.txt"));
  std::vector<double> times;
  for (std::size_t at = printed.find("time "); at != std::string::npos; at = printed.find("time ", at + 1))
    times.push_back(std::strtod(printed.c_str() + at + 5, nullptr));
  REQUIRE(times.size() == 3);
  CHECK(times[0] == Approx(0.2));
  CHECK(times[1] == 0);
  CHECK(times[2] >= 0.5);
  CHECK(bytes_of(folder / "plain.png") != bytes_of(folder / "forces.png"));
}

TEST_CASE("the mouse of the display drags a part, and the wheel and the right button move the camera",
          "[long]") {
  if (no_display()) return;
  const NewFolder folder;
  set_bytes(folder / "scene.json", kScene);
  // The ball is at about (380, 270) in a window of 960 x 540, which the display places at its corner.
  set_bytes(folder / "mouse.sh", with_mouse(R"(
xdotool mousemove --window "$window" 375 270
sleep 0.3
xdotool mousedown 1
sleep 0.3
for i in 1 2 3 4 5 6 7 8 9 10; do xdotool mousemove --window "$window" $((375 + 10 * i)) $((270 - 8 * i)); sleep 0.05; done
)"));
  set_bytes(folder / "script.txt", "key space\nuntil 6\nkey space\npictures 5\nreport\nkey w\n");
  const std::string printed = on_display(folder, "sh mouse.sh");
  const Report report = last_report(printed);
  std::string part;
  const Vec3<double> x = replayed_point(folder / "played.json", report.time, part);
  CHECK(part == "ball");
  CHECK((x - report.held).norm() <= 1e-6);
  CHECK(report.held.x() > 0.3);  // the ball has followed the mouse to the right and upwards
  CHECK(report.held.z() > 0.5);
}

TEST_CASE("sliders of the panel change gravity, a rest value and stiffnesses, and the saved scene has them",
          "[long]") {
  if (no_display()) return;
  const NewFolder folder;
  set_bytes(folder / "scene.json", kSpringScene);
  // A click on the ball selects it. Then the panel has sliders for its radius, the stiffness of the radius
  // and its spring. Each slider is moved to the right. The positions were read from a picture of the window.
  set_bytes(folder / "mouse.sh", with_mouse(R"(
move() {  # X Y X_END: the mouse moves with its button held
  xdotool mousemove --window "$window" "$1" "$2"; sleep 0.3
  xdotool mousedown 1; sleep 0.3
  xdotool mousemove --window "$window" "$3" "$2"; sleep 0.3
  xdotool mouseup 1; sleep 0.3
}
move 380 270 380
move 38 150 50
move 75 190 110
move 25 230 110
move 83 270 120
)"));
  set_bytes(folder / "script.txt",
            "key space\nuntil 20\nkey space\npictures 5\nphotograph window.png\nkey w\n");
  on_display(folder, "sh mouse.sh");
  Diagnostics diagnostics;
  const std::unique_ptr<Scene> scene = read_scene((folder / "played.json").string(), {}, diagnostics);
  REQUIRE(scene != nullptr);
  CHECK(scene->body.gravity_at(0) == Vec3<double>::Zero());
  const double end = 20;  // s
  CHECK(scene->body.gravity_at(end).x() > 5);
  const TimeFunction& radius = scene->body.parts()[0]->parameters().moving(0).rest;
  CHECK(radius.value(0) == 0.4);
  CHECK(radius.value(end) > 0.45);
  REQUIRE(scene->body.drives().size() == 1);
  const Drive& servo = *scene->body.drives().front();
  CHECK(servo.name == "ball.r");
  CHECK(servo.stiffness.of_time().value(0) == 0);
  CHECK(servo.stiffness.of_time().value(end) > 4000);
  const Spring& spring = *scene->body.springs().front();
  REQUIRE(spring.name == "band");
  CHECK(spring.stiffness.of_time().value(0) == 5);
  CHECK(spring.stiffness.of_time().value(end) > 10);
}

TEST_CASE("a build without a window names the packages to install") {
  if (missing_window_packages().empty()) return;
  std::unique_ptr<Scene> scene;
  Diagnostics diagnostics;
  scene = parse_scene("scene", kScene, {}, diagnostics);
  std::ostringstream out;
  CHECK_THROWS_WITH(view_scene(*scene, {}, out), test::has_text(missing_window_packages()));
}

}  // namespace window_test
