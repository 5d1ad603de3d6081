// Times of springs, straight key frames and the rate of stops in scenes.
#include <pliant/scene/read_scene.h>

#include <cmath>

#include "catch.h"

namespace spring_times_test {

using namespace pliant;

namespace {

std::unique_ptr<Scene> scene_with(const std::string& spring, const std::string& world) {
  Diagnostics diagnostics;
  return parse_scene(
      "scene",
      R"({"time": {"stop_rate": 30}, "parts": [{"name": "ball", "shape": "sphere"}], "springs": [
    {"from": {"part": "ball", "at": {"u": 0, "v": 0}}, "to": {"world": )" +
          world + R"(}, "stiffness": 10)" + spring + "}]}",
      {}, diagnostics);
}

const char* const kLines =
    R"({"t": [0, 1, 3], "points": [[2, 0, 0], [2, 1, 0], [2, 1, 4]], "interpolation": "linear"})";

}  // namespace

TEST_CASE("a scene sets the times of a spring, straight key frames and the rate of stops") {
  const auto scene = scene_with(R"(, "on": 0.5, "off": 2)", kLines);
  CHECK(scene->body.stop_rate == 30);
  const Spring& spring = *scene->body.springs().front();
  CHECK(spring.on == 0.5);
  CHECK(spring.off == 2);
  CHECK(spring.b.world.value(2) == Vec3<double>(2, 1, 2));
  CHECK(spring.b.world.first_kink(0, 5).time == 1);
  const auto always = scene_with("", "[2, 0, 0]");
  CHECK(always->body.springs().front()->acts_at(0));
  CHECK(std::isinf(always->body.springs().front()->off));
}

TEST_CASE("faulty times of a spring and end rates of straight key frames are refused") {
  CHECK_THROWS_WITH(scene_with(R"(, "on": 2, "off": 1)", kLines), test::has_text("after \"on\""));
  Diagnostics diagnostics;
  CHECK_THROWS_WITH(parse_scene("scene", R"({"parts": [{"name": "ball", "shape": "sphere"}],
    "gravity": [0, 0, {"t": [0, 1], "y": [0, 1], "interpolation": "linear", "end_rates": [0, 0]}]})",
                                {}, diagnostics),
                    test::has_text("straight lines have no end rates"));
}

}  // namespace spring_times_test
