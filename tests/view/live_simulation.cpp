// Drags and changed gravity of a live simulation: the motion is that of the same springs in the library, and
// the saved scene repeats the motion to the last bit.
#include <pliant/view/live_simulation.h>

#include <cstring>
#include <functional>

#include <pliant/body/placed_point.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/scheduled_step.h>
#include <pliant/scene/read_scene.h>
#include <pliant/view/save_scene.h>

#include "catch.h"

namespace live_simulation_test {

using namespace pliant;

namespace {

std::unique_ptr<Scene> parse(const std::string& text) {
  Diagnostics diagnostics;
  return parse_scene("scene", text, {}, diagnostics);
}

/// Returns a scene of an ellipsoid on a string, an arm on ball joints and a bar that bends, with these
/// settings of time.
std::string hung_scene(const std::string& time) {
  return R"({"time": )" + time + R"(,
  "parts": [
    {"name": "egg", "shape": "ellipsoid", "parameters": {"a1": 0.2, "a2": 0.1, "a3": 0.1}},
    {"name": "arm", "shape": "capsule", "parameters": {"r": 0.05, "l": 0.3}, "position": [1, 0, 0]},
    {"name": "hand", "shape": "capsule", "parameters": {"r": 0.05, "l": 0.3}, "position": [1, 0, -0.7]},
    {"name": "bar", "shape": "box", "deformations": ["bend"], "position": [2, 0, 0], "beta": 0.01,
     "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.4, "bend.angle": {"rest": 0, "stiffness": 300}}}],
  "joints": [
    {"type": "string", "from": {"part": "egg", "at": {"u": 0, "v": 0}}, "to": {"world": [0, 0, 0.5]}, "length": 0.6},
    {"type": "ball", "from": {"part": "arm", "at": {"u": 1.5707963267948966, "v": 0}}, "to": {"world": [1, 0, 0.35]}},
    {"type": "ball", "from": {"part": "hand", "at": {"u": 1.5707963267948966, "v": 0}},
     "to": {"part": "arm", "at": {"u": -1.5707963267948966, "v": 0}}}]
})";
}

const char* const kBar = R"({"time": {"tolerance": 1e-9},
  "parts": [{"name": "bar", "shape": "box", "deformations": ["bend"], "beta": 0.01,
             "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.4, "bend.angle": {"rest": 0, "stiffness": 300}}}]})";

/// Returns a scene of boxes that fall on a floor, come to rest there and sleep, with these settings of time.
std::string fallen_scene(const std::string& time, int boxes) {
  std::string parts;
  for (int i = 0; i < boxes; ++i)
    parts += std::string(i > 0 ? "," : "") + R"({"name": "box )" + std::to_string(i) +
             R"(", "shape": "box", "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.1}, "position": [)" +
             std::to_string(0.5 * (i % 4)) + ", " + std::to_string(0.5 * (i / 4)) + ", 0.12]}";
  return R"({"time": )" + time + R"(, "parts": [)" + parts +
         R"(], "contact": {"friction": 0.5, "sleep": {"speed": 0.01, "after": 0.1}, "planes": [{"name": "floor"}]}})";
}

/// Returns a scene of a soft ellipsoid without gravity, with these settings of time.
std::string jelly_scene(const std::string& time) {
  return R"({"gravity": [0, 0, 0], "time": )" + time + R"(,
  "parts": [{"name": "jelly", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.2}, "density": 500,
    "local": {"resolution": 2, "laws": [{"type": "neo_hookean", "E": 20000, "nu": 0.3}], "alpha": 1}}]})";
}

/// The actions of a user before interval k; an interval is one call of LiveSimulation::advance(). They grab a
/// part before the intervals 20 and 70, move the mouse, and release the part before the intervals 50 and 90.
void drag(LiveSimulation& live, const std::string& part, int k) {
  const Part& dragged = *live.scene().body.find(part);
  if (k == 20 || k == 70) {
    const SpringConstants spring = drag_spring(dragged);
    live.grab(point(dragged, 0.3, k == 20 ? 1.1 : -2.3), spring.stiffness, spring.damping);
  }
  if (live.is_dragging()) {
    const Vec3<double> start = live.drags().back().path.last();
    live.drag_to(start + 0.02 * Vec3<double>(std::sin(0.3 * k), std::cos(0.2 * k), k % 3 == 0 ? 0 : 0.5));
  }
  if (k == 50 || k == 90) live.release();
}

bool same_bits(const VecX<double>& a, const VecX<double>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

/// Plays a scene live, saves it, and checks that the saved scene gives the same bits after each interval.
/// act: the actions of the user before an interval.
void check_replay(const std::string& text, int intervals,
                  const std::function<void(LiveSimulation&, int)>& act) {
  const std::unique_ptr<Scene> scene = parse(text);
  std::vector<State> states;
  std::string saved;
  {
    LiveSimulation live(*scene);
    for (int k = 0; k < intervals; ++k) {
      act(live, k);
      live.advance();
      states.push_back(live.simulation().state());
    }
    saved = saved_scene(live, ".", ".");
  }
  const std::unique_ptr<Scene> again = parse(saved);
  const FrameSchedule schedule = schedule_of(*again);
  Simulation simulation(again->body, again->integrator, 1, again->tolerance);
  std::size_t next = 0;
  while (!at_end(simulation, schedule)) {
    scheduled_step(simulation, schedule);
    if (simulation.time() < states[next].time() - 1e-9) continue;
    INFO("interval " << next << ", t = " << simulation.time());
    REQUIRE(simulation.time() == Approx(states[next].time()).epsilon(1e-12));
    REQUIRE(same_bits(simulation.state().q, states[next].q));
    REQUIRE(same_bits(simulation.state().v, states[next].v));
    ++next;
  }
  CHECK(next == states.size());
}

/// Checks the replay of drags of a part.
void check_drags(const std::string& text, const std::string& part, int intervals = 100) {
  INFO("drags of " << part);
  check_replay(text, intervals, [&](LiveSimulation& live, int k) { drag(live, part, k); });
}

}  // namespace

TEST_CASE("a dragged point moves as the library moves it with the same spring") {
  const std::unique_ptr<Scene> scene = parse(kBar);
  LiveSimulation live(*scene);
  std::vector<Vec3<double>> seen;
  for (int k = 0; k < 60; ++k) {
    drag(live, "bar", k);
    live.advance();
    if (k >= 20)
      seen.push_back(
          PlacedPoint(live.simulation().model(), live.drags()[0].spring->a).at(live.simulation().state()));
  }
  const Drag& drag = live.drags()[0];

  // The same body with a spring that acts from the same time on, by a method with small fixed steps.
  const std::unique_ptr<Scene> other = parse(kBar);
  Point held = drag.spring->a;
  held.part = other->body.find("bar");
  TimeVector path;
  for (std::size_t i = 0; i < 3; ++i)
    path.component[i] = linear_key_frames(drag.path.component[i]->times(), drag.path.component[i]->values());
  Spring& spring =
      other->body.spring("hand", held, world(path), drag.spring->stiffness, drag.spring->damping);
  spring.on = drag.spring->on;
  spring.off = drag.spring->off;
  Simulation simulation(other->body, "dop853", 1, 1e-10);
  double worst = 0, travel = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double t = live.time_after(static_cast<std::int64_t>(21 + k));
    while (simulation.time() < t) simulation.step_up_to(t);
    const Vec3<double> x = PlacedPoint(simulation.model(), held).at(simulation.state());
    worst = std::max(worst, (x - seen[k]).norm());
    travel = std::max(travel, (x - seen[0]).norm());
  }
  CHECK(travel > 0.05);
  CHECK(worst <= 1e-6);
}

TEST_CASE("a dragged point follows the mouse in the next interval") {
  const std::unique_ptr<Scene> scene = parse(kBar), other = parse(kBar);
  LiveSimulation still(*scene), moved(*other);
  for (LiveSimulation* live : {&still, &moved}) {
    const Part& bar = *live->scene().body.find("bar");
    const SpringConstants spring = drag_spring(bar);
    live->grab(point(bar, 0.3, 1.1), spring.stiffness, spring.damping);
    for (int k = 0; k < 10; ++k) live->advance();
  }
  moved.drag_to(moved.drags()[0].path.last() + Vec3<double>(0.1, 0, 0));
  still.advance();
  moved.advance();
  const auto held = [](const LiveSimulation& live) {
    return PlacedPoint(live.simulation().model(), live.drags()[0].spring->a).at(live.simulation().state());
  };
  CHECK((held(moved) - held(still)).x() > 1e-3);
}

TEST_CASE("after a jump of the mouse, the end of the drag moves to the mouse at a bounded speed") {
  const std::unique_ptr<Scene> scene = parse(kBar);
  LiveSimulation live(*scene);
  const Part& bar = *scene->body.find("bar");
  const SpringConstants spring = drag_spring(bar);
  live.grab(point(bar, 0.3, 1.1), spring.stiffness, spring.damping);
  const Vec3<double> start = live.drags()[0].path.last(), jump = start + Vec3<double>(0, 0, 3);
  live.drag_to(jump);
  live.advance();
  const double first = (live.drags()[0].path.last() - start).norm();
  CHECK(first == Approx(LiveSimulation::kMaxHandSpeed * bar.size() / live.rate()));
  for (int k = 0; k < 120; ++k) live.advance();
  CHECK(live.drags()[0].path.last() == jump);
}

TEST_CASE("the ledger counts the work of a drag") {
  const std::unique_ptr<Scene> scene = parse(hung_scene(R"({"tolerance": 1e-9})"));
  LiveSimulation live(*scene);
  double largest = 0, worst = 0;
  for (int k = 0; k < 60; ++k) {
    drag(live, "egg", k);
    live.advance();
    const Ledger ledger = live.ledger();
    largest = std::max(largest, std::abs(ledger.work[static_cast<int>(Work::anchors)]));
    worst = std::max(worst, std::abs(ledger.balance));
  }
  CHECK(largest > 0.1);
  CHECK(worst <= 1e-6 * largest);
}

TEST_CASE("a saved scene repeats the drags to the last bit", "[long]") {
  const std::string tolerance = R"({"tolerance": 1e-6})", fixed = R"({"step": 0.002, "integrator": "rk4"})";
  SECTION("rigid parts, a string and an elastic part, with a tolerance") {
    check_drags(hung_scene(tolerance), "egg");
    check_drags(hung_scene(tolerance), "hand");
    check_drags(hung_scene(tolerance), "bar");
  }
  SECTION("with fixed steps") {
    check_drags(hung_scene(fixed), "egg");
    check_drags(hung_scene(fixed), "hand");
    check_drags(hung_scene(R"({"step": 0.002, "integrator": "linearly_implicit"})"), "bar");
  }
  SECTION("contact and sleep") {
    check_drags(fallen_scene(tolerance, 3), "box 1");
    check_drags(fallen_scene(fixed, 3), "box 1");
  }
  SECTION("clusters") {
    check_drags(fallen_scene(tolerance, 12), "box 5");
  }
  SECTION("local deformation") {
    check_drags(jelly_scene(R"({"step": 0.002, "integrator": "linearly_implicit"})"), "jelly", 60);
  }
}

TEST_CASE("changed gravity is repeated to the last bit") {
  auto change = [](LiveSimulation& live, int k) {
    if (k == 10) live.set_gravity({1, 0, -3});
    if (k == 25) live.set_gravity({0, 0, -9.81});
  };
  check_replay(fallen_scene(R"({"tolerance": 1e-6})", 3), 40, change);
  const auto change_islands = [&](LiveSimulation& live, int k) {
    change(live, k);
    CHECK(!live.simulation().model().rigid_islands().empty());
    CHECK(std::abs(live.ledger().balance) <= 1e-4);
  };
  check_replay(hung_scene(R"({"tolerance": 1e-6})"), 40, change_islands);
  check_replay(hung_scene(R"({"step": 0.002, "integrator": "rk4"})"), 40, change_islands);
}

TEST_CASE(
    "gravity that is added to changing gravity is repeated to the last bit, also by a scene that was saved") {
  const std::string start = R"({"gravity": )", end = R"(, "time": {"tolerance": 1e-6}, "parts": [
    {"name": "egg", "shape": "ellipsoid", "parameters": {"a1": 0.2, "a2": 0.1, "a3": 0.1}}]})";
  const std::string by_components = R"json([0, "sin(t)", {"t": [0, 1], "y": [0, -9]}])json",
                    by_points = R"({"t": [0, 0.2, 1], "points": [[0, 0, 0], [1, 0, 0], [0, 0, -9]]})",
                    by_sums = R"json([{"sum": ["t", 1, "2 * t"]}, 0, "-t"])json";
  const auto change = [](LiveSimulation& live, int k) {
    if (k == 10) live.set_gravity({1, 0, -3});
    if (k == 25) live.set_gravity({0, 0, 0});
  };
  for (const std::string& gravity : {by_components, by_points, by_sums}) {
    CAPTURE(gravity);
    check_replay(start + gravity + end, 40, change);
    const std::unique_ptr<Scene> scene = parse(start + gravity + end);
    const Vec3<double> before = scene->body.gravity_at(0.4);
    LiveSimulation live(*scene);
    live.set_gravity({0, 2, 0});
    for (int k = 0; k < 5; ++k) live.advance();
    const std::string saved = saved_scene(live, ".", ".");
    CHECK(parse(saved)->body.gravity_at(0.4).isApprox(before + Vec3<double>(0, 2, 0), 1e-15));
    check_replay(saved, 40, change);  // changed once more
    live.reset();
    CHECK(scene->body.gravity_at(0.4) == before);
  }
}

TEST_CASE(
    "changed stiffnesses of drives of parameters are repeated to the last bit, and the ledger balances") {
  const std::string part = R"({"name": "bar", "shape": "box", "deformations": ["bend"],
    "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.4, "bend.angle": {"rest": 0, "initial": 0.2, "drive": )";
  for (const char* drive :
       {R"({"target": 0, "stiffness": 300})", R"({"target": "0.2 * t", "stiffness": 300})"}) {
    CAPTURE(drive);
    for (const char* time : {R"({"tolerance": 1e-8})", R"({"step": 0.001, "integrator": "rk4"})"})
      check_replay(std::string(R"({"gravity": [0, 0, 0], "time": )") + time + R"(, "parts": [)" + part +
                       drive + "}}}]}",
                   40, [](LiveSimulation& live, int k) {
                     REQUIRE(live.drive_stiffnesses().size() == 1);
                     CHECK(live.parameter_stiffnesses().empty());
                     if (k == 10) live.set_drive_stiffness(0, 900);
                     if (k == 25) live.set_drive_stiffness(0, 100);
                     CHECK_THROWS_WITH(live.set_drive_stiffness(0, -1), test::has_text("bar.bend.angle"));
                     CHECK(std::abs(live.ledger().balance) <= 1e-6 * 6);  // the energy is 6 J
                   });
  }
  const std::unique_ptr<Scene> scene =
      parse(R"({"gravity": [0, 0, 0], "time": {"step": 0.01, "integrator": "rk4"},
    "parts": [)" +
            part + R"({"target": 0.1, "stiffness": 300}}}}]})");
  LiveSimulation live(*scene);
  const double most = live.drive_stiffnesses()[0].most;
  CHECK(most > 300);
  live.set_drive_stiffness(0, most);
  for (int k = 0; k < 100; ++k) live.advance();
  CHECK(live.simulation().state().v.cwiseAbs().maxCoeff() < 100);
  live.reset();
  CHECK(live.drive_stiffnesses()[0].next == 300);
  CHECK(scene->body.drives()[0]->stiffness.constant() == 300);
}

TEST_CASE("changed rest values are repeated to the last bit") {
  check_replay(kBar, 60, [](LiveSimulation& live, int k) {
    REQUIRE(live.rest_values().size() == 1);
    CHECK(live.rest_values()[0].parameter == "bend.angle");
    if (k == 10) live.set_rest_value(0, 0.6);
    if (k == 40) live.set_rest_value(0, -0.2);
    CHECK_THROWS_WITH(live.set_rest_value(0, 1e6), test::has_text("out of range"));
    drag(live, "bar", k);
  });
}

const char* const kSprung = R"({"time": {"tolerance": 1e-8},
  "parts": [{"name": "egg", "shape": "ellipsoid", "parameters": {"a1": 0.2, "a2": 0.1, "a3": 0.1}},
            {"name": "box", "shape": "box", "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.1}, "position": [0.5, 0, 0]}],
  "springs": [
    {"name": "up", "from": {"part": "egg", "at": {"u": 0, "v": 0}}, "to": {"world": [0, 0, 0.5]},
     "stiffness": 400, "damping": 1},
    {"name": "cord", "from": {"part": "box", "at": {"direction": [-1, 0, 0]}},
     "to": {"part": "egg", "at": {"direction": [1, 0, 0]}}, "stiffness": 300, "rest_length": 0.2}]})";

TEST_CASE("changed stiffnesses are repeated to the last bit, and the ledger balances") {
  for (const char* time : {R"({"tolerance": 1e-8})", R"({"step": 0.001, "integrator": "rk4"})"}) {
    std::string text = kSprung;
    text.replace(text.find(R"({"tolerance": 1e-8})"), std::string(R"({"tolerance": 1e-8})").size(), time);
    check_replay(text, 60, [](LiveSimulation& live, int k) {
      REQUIRE(live.stiffnesses().size() == 2);
      CHECK(live.stiffnesses()[1].spring->name == "cord");
      if (k == 10) live.set_stiffness(1, 900);
      if (k == 40) live.set_stiffness(1, 100);
      CHECK_THROWS_AS(live.set_stiffness(0, -1), std::invalid_argument);
      drag(live, "egg", k);
      CHECK(std::abs(live.ledger().balance) <= 1e-4);
    });
  }
}

TEST_CASE(
    "changed stiffnesses of a spring that acts for a time, at a sleeping box and at nodes, are repeated") {
  const auto change = [](LiveSimulation& live, int k) {
    if (k == 15 || k == 30) live.set_stiffness(0, 60 * k);
    if (k == 50) live.set_stiffness(0, 0);
  };
  SECTION("from on to off") {
    check_replay(R"({"time": {"tolerance": 1e-8},
      "parts": [{"name": "egg", "shape": "ellipsoid", "parameters": {"a1": 0.2, "a2": 0.1, "a3": 0.1}}],
      "springs": [{"name": "up", "from": {"part": "egg", "at": {"u": 0, "v": 0}}, "to": {"world": [0, 0, 0.5]},
                   "stiffness": 400, "damping": 1, "on": 0.25, "off": 0.9}]})",
                 70, change);
  }
  SECTION("a box that sleeps") {
    check_replay(R"({"time": {"tolerance": 1e-6},
      "parts": [{"name": "box", "shape": "box", "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.1}, "position": [0, 0, 0.11]}],
      "springs": [{"from": {"part": "box", "at": {"direction": [0, 0, 1]}}, "to": {"world": [0, 0, 1]},
                   "stiffness": 5, "rest_length": 0.5}],
      "contact": {"friction": 0.5, "sleep": {"speed": 0.01, "after": 0.1}, "planes": [{"name": "floor"}]}})",
                 70, change);
  }
  SECTION("nodes and linearly implicit steps") {
    check_replay(R"({"time": {"step": 0.002, "integrator": "linearly_implicit"},
      "parts": [{"name": "jelly", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.2}, "density": 500,
                 "local": {"resolution": 2, "laws": [{"type": "neo_hookean", "E": 20000, "nu": 0.3}], "alpha": 1}}],
      "springs": [{"from": {"part": "jelly", "at": {"u": 0, "v": 0}}, "to": {"world": [0.5, 0, 0.5]}, "stiffness": 400}]})",
                 60, change);
  }
}

TEST_CASE("changed stiffnesses of parameters are repeated to the last bit, and the ledger balances") {
  const auto change = [](LiveSimulation& live, int k) {
    REQUIRE(live.parameter_stiffnesses().size() == 1);
    CHECK(live.parameter_stiffnesses()[0].first == 300);
    if (k == 10) live.set_parameter_stiffness(0, 1500);
    if (k == 25) live.set_rest_value(0, 0.3);
    if (k == 33) live.set_parameter_stiffness(0, 30);
    if (k == 45) live.set_parameter_stiffness(0, 300);
    CHECK_THROWS_WITH(live.set_parameter_stiffness(0, -1), test::has_text("bar.bend.angle"));
  };
  SECTION("with a tolerance") {
    check_replay(kBar, 60, [&](LiveSimulation& live, int k) {
      change(live, k);
      drag(live, "bar", k);
      CHECK(std::abs(live.ledger().balance) <= 1e-4);
    });
  }
  const std::string tolerance = R"({"tolerance": 1e-9})";
  SECTION("implicit steps") {
    std::string text = kBar;
    text.replace(text.find(tolerance), tolerance.size(),
                 R"({"step": 0.004, "integrator": "implicit_midpoint"})");
    check_replay(text, 60, change);
  }
  SECTION("contact with a tolerance") {
    std::string text = kBar;
    text.replace(text.find(tolerance), tolerance.size(), R"({"tolerance": 0.001})");
    text.insert(text.rfind('}'), R"(, "contact": {"planes": [{"name": "floor", "point": [0, 0, -0.5]}]})");
    check_replay(text, 45, change);
  }
}

TEST_CASE("a parameter with a changed stiffness moves as with the sum of both stiffnesses") {
  const auto [changed, text] =
      GENERATE(std::pair(1500.0, "1500"), std::pair(40.0, "40"), std::pair(0.0, "0"));
  std::string stiff = kBar, soft = kBar;
  const std::string rest = R"("rest": 0, )", damping = R"("beta": 0.01,)";
  for (std::string* scene : {&stiff, &soft}) {
    scene->replace(scene->find(rest), rest.size(), R"("rest": 0, "initial": 0.4, )");
    scene->erase(scene->find(damping),
                 damping.size());  // a damping of beta K_s would depend on the stiffness
  }
  stiff.replace(stiff.find("300"), 3, text);
  const std::unique_ptr<Scene> moved = parse(soft), other = parse(stiff);
  LiveSimulation live(*moved);
  live.set_parameter_stiffness(0, changed);
  live.advance();  // the stiffness changes in this interval
  State state = live.simulation().state();
  Simulation simulation(other->body, "dop853", 1, 1e-10);
  simulation.set_state(state);
  const double end = live.time_after(31);
  for (int k = 0; k < 30; ++k) live.advance();
  while (simulation.time() < end) simulation.step_up_to(end);
  CHECK((simulation.state().q - live.simulation().state().q).cwiseAbs().maxCoeff() <= 1e-7);
  CHECK((state.q - live.simulation().state().q).cwiseAbs().maxCoeff() > 1e-2);
}

TEST_CASE("a reset simulation has the first stiffnesses") {
  const std::unique_ptr<Scene> scene = parse(kSprung), fresh = parse(kSprung);
  LiveSimulation live(*scene), other(*fresh);
  for (int k = 0; k < 20; ++k) {
    if (k == 5) live.set_stiffness(0, 900);
    live.advance();
  }
  live.reset();
  for (int k = 0; k < 20; ++k) {
    live.advance();
    other.advance();
  }
  CHECK(same_bits(live.simulation().state().q, other.simulation().state().q));
}

TEST_CASE("a reset simulation has the first stiffnesses of parameters, and can change them again") {
  const std::unique_ptr<Scene> scene = parse(kBar), fresh = parse(kBar);
  LiveSimulation live(*scene), other(*fresh);
  live.set_parameter_stiffness(0, 90);
  for (int k = 0; k < 10; ++k) live.advance();
  live.reset();
  CHECK(scene->body.drives().empty());
  for (LiveSimulation* each : {&live, &other})
    for (int k = 0; k < 20; ++k) {
      if (k == 5) each->set_rest_value(0, 0.3);
      if (k == 10) each->set_parameter_stiffness(0, 700);
      each->advance();
    }
  CHECK(same_bits(live.simulation().state().q, other.simulation().state().q));
  CHECK(saved_scene(live, ".", ".") == saved_scene(other, ".", "."));
}

TEST_CASE("a reset simulation has the first local stiffness, and can change it again") {
  const std::string text = jelly_scene(R"({"step": 0.002, "integrator": "rk4"})");
  const std::unique_ptr<Scene> scene = parse(text), fresh = parse(text);
  LiveSimulation live(*scene), other(*fresh);
  live.set_local_stiffness(0, 0.3);
  for (int k = 0; k < 10; ++k) live.advance();
  live.reset();
  for (LiveSimulation* each : {&live, &other})
    for (int k = 0; k < 50; ++k) {
      if (k == 30) each->set_local_stiffness(0, 0.5);
      drag(*each, "jelly", k);
      each->advance();
    }
  CHECK(same_bits(live.simulation().state().q, other.simulation().state().q));
  CHECK(saved_scene(live, ".", ".") == saved_scene(other, ".", "."));
}

TEST_CASE("a changed stiffness of a sleeping part is repeated to the last bit", "[long]") {
  check_replay(R"({"time": {"tolerance": 1e-6},
    "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": {"rest": 0.1, "stiffness": 20000}},
               "position": [0, 0, 0.101], "beta": 0.01, "alpha": 5}],
    "contact": {"friction": 0.5, "sleep": {"speed": 0.01, "after": 0.1}, "planes": [{"name": "floor"}]}})",
               120, [](LiveSimulation& live, int k) {
                 if (k == 60) live.set_parameter_stiffness(0, 50000);
                 if (k == 90) live.set_parameter_stiffness(0, 5000);
               });
}

TEST_CASE("parameters with a stiffness matrix can be made stiffer only, and are saved with their rest values",
          "[long]") {
  check_replay(R"({"time": {"step": 0.002, "integrator": "rk4"}, "gravity": [0, 0, 0],
    "parts": [{"name": "bar", "shape": "box", "deformations": ["bend", "taper"],
               "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.4, "taper.tx": 0.1, "bend.angle": {"rest": 0, "initial": 0.3}},
               "stiffness_matrix": {"parameters": ["bend.angle", "taper.tx"], "K": [[300, 20], [20, 200]]}}]})",
               40, [](LiveSimulation& live, int k) {
                 REQUIRE(live.parameter_stiffnesses().size() == 2);
                 if (k == 10) live.set_parameter_stiffness(1, 800);
                 if (k == 20) live.set_parameter_stiffness(0, 600);
                 CHECK_THROWS_WITH(live.set_parameter_stiffness(0, 299), test::has_text("at least 300"));
               });
}

TEST_CASE("changed local stiffnesses are repeated to the last bit, and the ledger balances") {
  const auto change = [](LiveSimulation& live, int k) {
    REQUIRE(live.local_stiffnesses().size() == 1);
    CHECK(live.local_stiffnesses()[0].most > 1.5);
    if (k == 10) live.set_local_stiffness(0, 1.5);
    if (k == 20) live.set_local_stiffness(0, 0.2);
    if (k == 35) live.set_local_stiffness(0, 1);
    CHECK_THROWS_WITH(live.set_local_stiffness(0, -1), test::has_text("jelly"));
  };
  SECTION("explicit steps") {
    check_replay(jelly_scene(R"({"step": 0.001, "integrator": "rk4"})"), 50,
                 [&](LiveSimulation& live, int k) {
                   change(live, k);
                   drag(live, "jelly", k);
                   const Ledger ledger = live.ledger();  // the drags alone have an error of the same size
                   CHECK(std::abs(ledger.balance) <=
                         1e-8 + 1e-2 * std::abs(ledger.work[static_cast<int>(Work::anchors)]));
                 });
  }
  SECTION("implicit steps") {
    check_replay(jelly_scene(R"({"step": 0.004, "integrator": "linearly_implicit"})"), 50, change);
  }
  SECTION("modes with a tolerance") {
    check_replay(R"({"time": {"tolerance": 1e-6}, "gravity": [0, 0, 0],
      "parts": [{"name": "jelly", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.2}, "density": 500,
                 "local": {"basis": "polynomial", "degree": 2, "laws": [{"type": "elastic", "E": 20000, "nu": 0.3}],
                           "dents": [{"at": [0.3, 0, 0], "radius": 0.2, "displacement": [0.05, 0, 0]}]}}]})",
                 50, change);
  }
  SECTION("a part that sleeps") {
    check_replay(R"({"time": {"step": 0.001, "integrator": "semi_implicit_euler"},
      "parts": [{"name": "jelly", "shape": "ellipsoid", "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.1}, "density": 500,
                 "position": [0, 0, 0.101],
                 "local": {"resolution": 2, "laws": [{"type": "neo_hookean", "E": 20000, "nu": 0.3}], "alpha": 20}}],
      "contact": {"friction": 0.5, "sleep": {"speed": 0.05, "after": 0.1}, "planes": [{"name": "floor"}]}})",
                 60, change);
  }
}

TEST_CASE("the largest factor of the local stiffness keeps the fixed steps stable, also of modes", "[long]") {
  const std::unique_ptr<Scene> scene = parse(jelly_scene(R"({"step": 0.002, "integrator": "rk4"})"));
  LiveSimulation live(*scene);
  REQUIRE(live.local_stiffnesses().size() == 1);
  const double most = live.local_stiffnesses()[0].most;
  CAPTURE(most);
  CHECK(most > 1);
  CHECK(most < 100);
  live.set_local_stiffness(0, most);
  for (int k = 0; k < 120; ++k) {
    drag(live, "jelly", k);
    live.advance();
  }
  CHECK(live.simulation().state().v.cwiseAbs().maxCoeff() < 20);
  // The modes of a stiff part are faster than its steps, which are exact for the stiffness of the scene only.
  const std::unique_ptr<Scene> stiff =
      parse(R"({"time": {"step": 0.01, "integrator": "rk4"}, "gravity": [0, 0, 0],
      "parts": [{"name": "jelly", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.2}, "density": 500,
                 "local": {"basis": "polynomial", "degree": 3, "laws": [{"type": "elastic", "E": 2e7, "nu": 0.3}]}}]})");
  CHECK(LiveSimulation(*stiff).local_stiffnesses().empty());
}

TEST_CASE("a reset simulation repeats its first motion") {
  const std::unique_ptr<Scene> scene = parse(hung_scene(R"({"tolerance": 1e-6})"));
  LiveSimulation live(*scene);
  for (int k = 0; k < 30; ++k) live.advance();
  const State first = live.simulation().state();
  live.reset();
  for (int k = 0; k < 40; ++k) {
    drag(live, "hand", k);
    live.advance();
  }
  live.reset();
  CHECK(live.drags().empty());
  CHECK(live.simulation().time() == 0);
  for (int k = 0; k < 30; ++k) live.advance();
  CHECK(same_bits(live.simulation().state().q, first.q));
}

TEST_CASE(
    "a drag of any part of the paper's figures is stable, and a held point without joints comes nearer to "
    "the hand",
    "[long]") {
  for (const char* name : {"pull", "soft_pull", "gallery", "balloons", "dragonfly", "snowman", "springboard"})
    for (const double strength : {1.0, 1000.0}) {  // the middle and the end of the slider of the window
      Diagnostics diagnostics;
      const std::unique_ptr<Scene> scene =
          read_scene(std::string(PLIANT_SCENES) + "/" + name + ".json", {}, diagnostics);
      LiveSimulation live(*scene);
      for (const auto& part : scene->body.parts()) {
        if (part->fixed()) continue;
        CAPTURE(name, part->name(), strength);
        const SpringConstants spring = drag_spring(*part);
        Point held = point(*part, 0.2, 0.5);
        if (part->local() != nullptr) held.patch = 0.1 * part->size();
        live.grab(held, strength * spring.stiffness, std::sqrt(strength) * spring.damping);
        const Vec3<double> hand = live.drags().back().target + 0.3 * part->size() * Vec3<double>::UnitZ();
        live.drag_to(hand);
        const auto distance = [&] {
          return (PlacedPoint(live.simulation().model(), live.drags().back().spring->a)
                      .at(live.simulation().state()) -
                  hand)
              .norm();
        };
        const double before = distance();
        double nearest = before;
        for (int k = 0; k < 15; ++k) {
          REQUIRE_NOTHROW(live.advance());
          nearest = std::min(nearest, distance());
          REQUIRE(distance() < 3 * before + 0.5);
        }
        const auto& joints = live.simulation().model().joints();
        const bool joined = std::any_of(joints.begin(), joints.end(), [&](const JointModel& joint) {
          const auto& points = joint.joint->points();
          return std::any_of(points.begin(), points.end(),
                             [&](const Point& p) { return p.part == part.get(); });
        });
        CHECK((joined || nearest < 0.9 * before));
        live.release();
        for (int k = 0; k < 5; ++k) REQUIRE_NOTHROW(live.advance());
      }
    }
}

TEST_CASE("the largest stiffness of a spring or a parameter keeps the fixed steps stable") {
  const std::unique_ptr<Scene> scene =
      parse(R"({"time": {"step": 0.01, "integrator": "rk4"}, "gravity": [0, 0, 0],
    "parts": [{"name": "bar", "shape": "box", "deformations": ["bend"], "mass": 2,
               "parameters": {"a1": 0.1, "a2": 0.1, "a3": 0.4, "bend.angle": {"rest": 0.2, "initial": 0, "stiffness": 300}}}],
    "springs": [{"name": "cord", "from": {"part": "bar", "at": {"direction": [0, 0, 1]}}, "to": {"world": [0, 0, 1]},
                 "stiffness": 4000, "rest_length": 0.5}]})");
  LiveSimulation live(*scene);
  const SpringStiffness& spring = live.stiffnesses().at(0);
  const ParameterStiffness& bend = live.parameter_stiffnesses().at(0);
  CAPTURE(spring.most, bend.most);
  CHECK(spring.most > spring.first);
  CHECK(bend.most > bend.first);
  CHECK((spring.most < 10 * spring.first || bend.most < 100 * bend.first));
  live.set_stiffness(0, spring.most);
  live.set_parameter_stiffness(0, bend.most);
  for (int k = 0; k < 100; ++k) live.advance();
  CHECK(live.simulation().state().v.cwiseAbs().maxCoeff() < 100);
}

TEST_CASE("only points of moving parts can be dragged") {
  const std::unique_ptr<Scene> scene = parse(R"({"parts": [{"name": "wall", "shape": "box", "fixed": true},
    {"name": "ball", "shape": "sphere", "position": [3, 0, 0]}]})");
  LiveSimulation live(*scene);
  CHECK_THROWS_WITH(live.grab(point(*scene->body.find("wall"), 0, 0), 1, 1), test::has_text("moving parts"));
  CHECK_THROWS_WITH(live.grab(point(*scene->body.find("ball"), 0, 0), -1, 1), test::has_text("stiffness"));
  CHECK_FALSE(live.is_dragging());
}

}  // namespace live_simulation_test
