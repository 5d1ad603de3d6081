// Records of a scene describe its keys. The tests cover the checks and messages, and the values that readers
// provide. They also cover the JSON Schema, which is generated from the records and checked by an independent
// validator. tests/README.md explains the numbers I01, I02, ... in test names (stress catalogue).
#include <pliant/scene/schema/schema.h>

#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/scene/json/json_document.h>
#include <pliant/scene/point_value.h>
#include <pliant/scene/reader/reader.h>
#include <pliant/scene/time_value.h>
#include <pliant/scene/validate.h>

#include "catch.h"
#include "schema_judge.h"

namespace schema_test {

using pliant::Diagnostics;
using pliant::JsonDocument;
using pliant::MaterialPointValue;
using pliant::Reader;
using namespace pliant::schema;

namespace {

/// Returns a small scene record, which has fields of all kinds of types.
const Record& scene() {
  static const Record root = [] {
    const Record sphere{"sphere", "A ball.", {optional("radius", number(above(0), "m"), "Radius.", "1")}};
    const Record ellipsoid{
        "superellipsoid",
        "A superellipsoid.",
        {optional("a", vector3("m", above(0)), "Half axes.", "[1, 1, 1]"),
         optional("eps1", number(between(0.02, 5), "1"), "Exponent from pole to pole.", "1"),
         optional("eps2", number(between(0.02, 5), "1"), "Exponent around the axis.", "1")}};
    const Record taper{"taper",
                       "Scales the section linearly along z.",
                       {optional("tx", number(between(-1, 1), "1"), "Taper of x.", "0"),
                        optional("ty", number(between(-1, 1), "1"), "Taper of y.", "0")}};
    const Record twist{"twist",
                       "Turns the section in proportion to z.",
                       {required("angle", number(unbounded(), "rad"), "Angle at the end.", "0.5")}};
    const Record dynamic{"dynamic_parameter",
                         "A parameter that moves.",
                         {required("value", number(unbounded(), ""), "Value at the start.", "0"),
                          optional("stiffness", number(at_least(0), ""), "Stiffness.", "0"),
                          optional("rest", time_function(""), "Rest value; by default the value.")}};
    const Record part{"part",
                      "A solid.",
                      {required("name", name(), "Name of the part, unique.", "\"arm\""),
                       required("shape", tagged("type", {sphere, ellipsoid}), "Shape of the part.",
                                "{\"type\": \"sphere\"}"),
                       optional("deformations", array(tagged("type", {taper, twist})),
                                "Chain, applied in this order.", "[]"),
                       optional("density", number(above(0), "kg/m^3"), "Mass per rest volume."),
                       optional("mass", number(above(0), "kg"), "Mass."),
                       optional("fixed", boolean(), "The part does not move.", "false"),
                       optional("position", vector3("m"), "Place of the frame.", "[0, 0, 0]"),
                       optional("parameters",
                                map(one_of({number(unbounded(), ""), record(dynamic)})
                                        .expecting("a number or {\"value\": ...}")),
                                "Parameters by name.", "{}")},
                      {{{"density", "mass"}, true}}};
    const Record spring{"spring",
                        "A linear spring.",
                        {required("part", name(), "Part it pulls.", "\"arm\""),
                         required("at", material_point(), "Point of the part.", "{\"near\": [0, 0, 1]}"),
                         required("to", time_vector("m"), "Point of the world.", "[0, 0, 2]"),
                         optional("stiffness", time_function("N/m"), "Stiffness.", "100"),
                         optional("rest_length", number(at_least(0), "m"), "Length without force.", "0")}};
    const Record solver{
        "solver",
        "How time advances.",
        {optional("method", choice({{"euler", "semi-implicit Euler"}, {"rk4", "Runge-Kutta, order 4"}}),
                  "Integrator.", "\"rk4\""),
         optional("substeps", integer(between(1, 1000)), "Steps per output.", "1"),
         optional("step", one_of({number(above(0), "s"), choice({{"auto", "chosen by the program"}})}),
                  "Time step.", "\"auto\"")}};
    return Record{
        "scene",
        "A scene.",
        {required("parts", array(record(part)), "The parts.", "[]"),
         optional("springs", array(record(spring)), "The springs.", "[]"),
         optional("solver", record(solver), "How time advances."), optional("title", text(1), "A title.")}};
  }();
  return root;
}

/// Returns the messages about a scene with this text; empty if the scene is valid.
std::string faults(const std::string& text) {
  Diagnostics diagnostics;
  try {
    const JsonDocument document = JsonDocument::parse("s.json", text, diagnostics);
    validate(document, scene(), diagnostics);
  } catch (const pliant::SceneError& e) {
    return e.what();
  }
  return diagnostics.text();
}

/// Return the messages about a scene with one part, spring or solver that has the given members. The part
/// also has a name, a shape and a mass. The spring also has the key "part".
std::string part_faults(const std::string& members) {
  return faults("{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}, \"mass\": 1,\n" + members +
                "}]}");
}
std::string spring_faults(const std::string& members) {
  return faults("{\"parts\": [], \"springs\": [{\"part\": \"a\",\n" + members + "}]}");
}
std::string solver_faults(const std::string& members) {
  return faults("{\"parts\": [], \"solver\": {\n" + members + "}}");
}

const char* const kGood = R"json({
  "$schema": "scene.schema.json", "//": "all there is", "//": "twice", "x-editor": {"zoom": 2},
  "title": "t",
  "parts": [
    {"name": "arm", "shape": {"type": "superellipsoid", "a": [1, 2, 3], "eps1": 0.5, "//": 1}, "density": 1000,
     "deformations": [{"type": "taper", "tx": 0.5}, {"type": "twist", "angle": 1}, {"type": "taper"}],
     "parameters": {"a1": 2, "taper.tx": {"value": 0.1, "stiffness": 5, "rest": "0.1*sin(t)"}, "x-a": "ignored"}},
    {"name": "ball", "shape": {"type": "sphere"}, "mass": 2, "fixed": true}
  ],
  "springs": [
    {"part": "arm", "at": {"u": 0.1, "v": 0.2}, "to": [0, "sin(t)", {"t": [0, 1], "y": [0, 2]}]},
    {"part": "arm", "at": {"direction": [0, 0, 1], "w": 0.5}, "to": [0, 0, 1], "stiffness": "100*step(t - 1)"},
    {"part": "arm", "at": {"near": [0, 0, 1]}, "to": {"t": [0, 1, 2], "points": [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}}
  ],
  "solver": {"method": "euler", "substeps": 3, "step": 1e-3}
})json";

}  // namespace

TEST_CASE("a valid scene has no errors") {
  CHECK(faults(kGood) == "");
}

TEST_CASE("I08 I09 I10 invalid counts are refused") {
  const std::string range = "; expected an integer in [1, 1000]";
  CHECK(solver_faults("\"substeps\": 123456789012345678901234567890") ==
        "s.json:2:13: error: /solver/substeps: 123456789012345678901234567890" + range + "\n");
  CHECK(solver_faults("\"substeps\": -5") == "s.json:2:13: error: /solver/substeps: -5" + range + "\n");
  CHECK(solver_faults("\"substeps\": 3.9") == "s.json:2:13: error: /solver/substeps: 3.9" + range + "\n");
  CHECK(solver_faults("\"substeps\": 1001") == "s.json:2:13: error: /solver/substeps: 1001" + range + "\n");
  CHECK(solver_faults("\"substeps\": 3.0").empty());
  CHECK(solver_faults("\"substeps\": 1e2").empty());
}

TEST_CASE("I12 unknown keys are reported with the nearest name") {
  CHECK(part_faults("\"densty\": 3") ==
        "s.json:2:1: error: /parts/0/densty: unknown key; did you mean \"density\"?\n");
  CHECK(part_faults("\"colour\": 3") ==
        "s.json:2:1: error: /parts/0/colour: unknown key; expected one of \"name\", \"shape\", "
        "\"deformations\", "
        "\"density\", \"mass\", \"fixed\", \"position\", \"parameters\"\n");
  CHECK(part_faults("\"x-colour\": 3, \"//\": [], \"//\": {}").empty());
  CHECK(part_faults("\"$schema\": \"s\"").find("unknown key") != std::string::npos);
  CHECK(part_faults("\"a/b~c\": 1").rfind("s.json:2:1: error: /parts/0/a~1b~0c: unknown key", 0) == 0);
  CHECK(part_faults("\"a\\u001b[31m\\n\": 1")
            .rfind("s.json:2:1: error: /parts/0/a\\x1b[31m\\n: unknown key", 0) == 0);
}

TEST_CASE("I13 keys in the wrong place are reported with their right place") {
  CHECK(faults("{\"parts\": [], \"density\": 3}") ==
        "s.json:1:15: error: /density: unknown key; it belongs to /parts/*\n");
  CHECK(part_faults("\"radius\": 3") ==
        "s.json:2:1: error: /parts/0/radius: unknown key; it belongs to /parts/*/shape of type \"sphere\"\n");
  CHECK(part_faults("\"deformations\": [{\"type\": \"taper\", \"angle\": 1}]") ==
        "s.json:2:36: error: /parts/0/deformations/0/angle: unknown key; it belongs to "
        "/parts/*/deformations/* of type \"twist\"\n");
}

TEST_CASE("I14 wrong types are refused") {
  CHECK(part_faults("\"position\": 3") ==
        "s.json:2:13: error: /parts/0/position: 3; expected 3 numbers [x, y, z] (m)\n");
  CHECK(part_faults("\"position\": [0, \"1\", null]") ==
        "s.json:2:17: error: /parts/0/position/1: \"1\"; expected a number (m), not in quotes\n"
        "s.json:2:22: error: /parts/0/position/2: null; expected a number (m)\n");
  CHECK(part_faults("\"fixed\": 1") ==
        "s.json:2:10: error: /parts/0/fixed: 1; expected true or false, not a number\n");
  CHECK(part_faults("\"fixed\": \"true\"") ==
        "s.json:2:10: error: /parts/0/fixed: \"true\"; expected true or false, not in quotes\n");
  CHECK(faults("[]") == "s.json:1:1: error: []; expected an object with \"parts\"\n");
  CHECK(
      faults("{\"parts\": {}}") ==
      "s.json:1:11: error: /parts: an empty object; expected an array of objects with \"name\", \"shape\"\n");
  CHECK(faults("{\"parts\": [3]}") ==
        "s.json:1:12: error: /parts/0: 3; expected an object with \"name\", \"shape\"\n");
  CHECK(faults("{\"parts\": [], \"title\": \"\"}") ==
        "s.json:1:24: error: /title: \"\"; expected a text in quotes that is not empty\n");
}

TEST_CASE("I15 wrong array lengths are refused") {
  CHECK(part_faults("\"position\": [0, 1]") ==
        "s.json:2:13: error: /parts/0/position: [0, 1]; expected 3 numbers [x, y, z] (m)\n");
  CHECK(part_faults("\"position\": [0, 1, 2, 3]") ==
        "s.json:2:13: error: /parts/0/position: [0, 1, 2, 3]; expected 3 numbers [x, y, z] (m)\n");
}

TEST_CASE("I16 unknown choices are reported with the list and the nearest name") {
  CHECK(solver_faults("\"method\": \"rk5\"") ==
        "s.json:2:11: error: /solver/method: \"rk5\"; expected one of \"euler\", \"rk4\"; did you mean "
        "\"rk4\"?\n");
  CHECK(part_faults("\"deformations\": [{\"type\": \"tapper\"}]") ==
        "s.json:2:27: error: /parts/0/deformations/0/type: \"tapper\"; expected one of \"taper\", \"twist\"; "
        "did you mean "
        "\"taper\"?\n");
  CHECK(part_faults("\"deformations\": [{\"type\": 3}]") ==
        "s.json:2:27: error: /parts/0/deformations/0/type: 3; expected one of \"taper\", \"twist\"\n");
  CHECK(part_faults("\"deformations\": [{\"tx\": 3}]") ==
        "s.json:2:18: error: /parts/0/deformations/0: missing key \"type\"; expected one of \"taper\", "
        "\"twist\"\n");
}

TEST_CASE("I17 missing keys are reported with an example") {
  CHECK(faults("{}") ==
        "s.json:1:1: error: missing key \"parts\"; expected an array of objects with \"name\", \"shape\", "
        "for example \"parts\": []\n");
  CHECK(faults("{\"parts\": [{\"mass\": 1}]}") ==
        "s.json:1:12: error: /parts/0: missing key \"name\"; expected a name in quotes, without \"/\" and "
        "control "
        "characters, of 1 to 100 bytes, for example \"name\": \"arm\"\n"
        "s.json:1:12: error: /parts/0: missing key \"shape\"; expected an object with \"type\", for example "
        "\"shape\": "
        "{\"type\": \"sphere\"}\n");
}

TEST_CASE("I25 invalid names are refused") {
  for (const char* bad : {"\"\"", "\"a/b\"", "\"a\\nb\"", "\"a\\u001b[2J\"", "\"a\\u007f\""}) {
    INFO(bad);
    const std::string text = faults("{\"parts\": [{\"name\": " + std::string(bad) +
                                    ", \"mass\": 1, \"shape\": {\"type\": \"sphere\"}}]}");
    CHECK(text ==
          "s.json:1:21: error: /parts/0/name: " + std::string(bad) +
              "; expected a name in quotes, without \"/\" and control characters, of 1 to 100 bytes\n");
  }
}

TEST_CASE("I28 I30 values out of range are refused") {
  CHECK(part_faults("\"//\": 0").empty());
  for (const char* bad : {"0", "-1", "-0.0"}) {
    CHECK(faults("{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}, \"mass\": " +
                 std::string(bad) + "}]}") ==
          "s.json:1:63: error: /parts/0/mass: " + std::string(bad) + "; expected a number > 0 (kg)\n");
  }
  CHECK(part_faults(
            "\"deformations\": [{\"type\": \"taper\", \"tx\": -1.5}, {\"type\": \"taper\", \"ty\": 1}]") ==
        "s.json:2:42: error: /parts/0/deformations/0/tx: -1.5; expected a number in [-1, 1]\n");
}

TEST_CASE("keys that exclude each other are refused") {
  CHECK(part_faults("\"density\": 3") ==
        "s.json:2:1: error: /parts/0/density: given beside \"mass\"; expected only one of \"density\", "
        "\"mass\"\n");
  CHECK(faults("{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}}]}") ==
        "s.json:1:12: error: /parts/0: missing key; expected one of \"density\", \"mass\"\n");
}

TEST_CASE("alternatives: the type of the value selects one, and only its errors are shown") {
  const std::string at = "\"at\": {\"near\": [0, 0, 0]}, ";
  CHECK(spring_faults(at + "\"to\": [0, 0, 0], \"stiffness\": true") ==
        "s.json:2:58: error: /springs/0/stiffness: true; expected a number (N/m), a formula of t in quotes, "
        "or key frames "
        "{\"t\": [...], \"y\": [...]}\n");
  CHECK(
      spring_faults(at + "\"to\": [0, 0, 0], \"stiffness\": {}") ==
      "s.json:2:58: error: /springs/0/stiffness: an empty object; expected a number (N/m), a formula of t in "
      "quotes, or key frames {\"t\": [...], \"y\": [...]}\n");
  CHECK(spring_faults(at + "\"to\": [0, 0, 0], \"stiffness\": {\"t\": [0]}") ==
        "s.json:2:58: error: /springs/0/stiffness: missing key \"y\"; expected an array of one or more "
        "numbers, for example \"y\": [0, 0.5, 0]\n");
  CHECK(spring_faults(at + "\"to\": [0, 0, 0], \"stiffness\": {\"sum\": 1}") ==
        "s.json:2:66: error: /springs/0/stiffness/sum: 1; expected an array of one or more numbers, "
        "formulas of t in quotes, or key frames; did you mean [1]?\n");
  CHECK(spring_faults(at + "\"to\": \"up\"") ==
        "s.json:2:34: error: /springs/0/to: \"up\"; expected [x, y, z] of numbers (m) or formulas of t in "
        "quotes, or key "
        "frames {\"t\": [...], \"points\": [...]}\n");
  CHECK(spring_faults(at + "\"to\": [0, 0]") ==
        "s.json:2:34: error: /springs/0/to: [0, 0]; expected [x, y, z] of numbers (m) or "
        "formulas of t in "
        "quotes, or key frames {\"t\": [...], \"points\": [...]}\n");
  CHECK(spring_faults("\"to\": [0, 0, 0], \"at\": {\"u\": 9, \"v\": 0}") ==
        "s.json:2:30: error: /springs/0/at/u: 9; expected a number in [-3.1416, 3.1416] (rad)\n");
  CHECK(spring_faults("\"to\": [0, 0, 0], \"at\": {\"directon\": [0, 0, 1]}") ==
        "s.json:2:24: error: /springs/0/at: an object with \"directon\"; expected a material point "
        "{\"u\", \"v\", \"w\"}, {\"direction\": [x, y, z], \"w\"} or {\"near\": [x, y, z]}; did you mean "
        "\"direction\"?\n");
  CHECK(spring_faults("\"to\": [0, 0, 0], \"at\": {\"direction\": [0, 0, 0]}") ==
        "s.json:2:38: error: /springs/0/at/direction: [0, 0, 0]; expected a direction that is not "
        "zero\n");
  CHECK(spring_faults("\"to\": [0, 0, 0], \"at\": {\"near\": [0, 0, 0], \"w\": 1}") ==
        "s.json:2:44: error: /springs/0/at/w: given beside \"near\"; expected a material point "
        "{\"u\", \"v\", \"w\"}, {\"direction\": [x, y, z], \"w\"} or {\"near\": [x, y, z]}\n");
  CHECK(solver_faults("\"step\": \"fast\"") ==
        "s.json:2:9: error: /solver/step: \"fast\"; expected \"auto\"\n");
  CHECK(solver_faults("\"step\": -1") == "s.json:2:9: error: /solver/step: -1; expected a number > 0 (s)\n");
  CHECK(solver_faults("\"step\": null") ==
        "s.json:2:9: error: /solver/step: null; expected a number > 0 (s) or \"auto\"\n");
  CHECK(part_faults("\"parameters\": {\"a1\": {\"value\": \"x\"}}") ==
        "s.json:2:32: error: /parts/0/parameters/a1/value: \"x\"; expected a number, not in quotes\n");
  CHECK(part_faults("\"parameters\": {\"a1\": []}") ==
        "s.json:2:22: error: /parts/0/parameters/a1: []; expected a number or {\"value\": "
        "...}\n");
}

TEST_CASE("errors in formulas are reported with their position in the text") {
  CHECK(
      spring_faults("\"at\": {\"near\": [0, 0, 0]}, \"to\": [0, \"2*sine(t)\", \"1 +\"]") ==
      "s.json:2:41: error: /springs/0/to/1: \"2*sine(t)\"; unknown function \"sine\"; did you mean \"sin\"?\n"
      "s.json:2:55: error: /springs/0/to/2: \"1 +\"; expected a number, t, pi, a function or \"(\", but the "
      "formula ends "
      "here\n");
  CHECK(spring_faults("\"at\": {\"near\": [0, 0, 0]}, \"to\": [0, \"\\u0032*x\", \"\"]") ==
        "s.json:2:46: error: /springs/0/to/1: \"\\u0032*x\"; unknown name \"x\"; did you mean \"t\"?\n"
        "s.json:2:50: error: /springs/0/to/2: \"\"; expected a formula of t in quotes\n");
}

TEST_CASE("errors of key frames are reported") {
  const std::string begin = "\"at\": {\"near\": [0, 0, 0]}, \"to\": [0, 0, 0], \"stiffness\": ";
  CHECK(spring_faults(begin + "{\"t\": [0, 1, 1], \"y\": [0, 1, 2]}") ==
        "s.json:2:71: error: /springs/0/stiffness/t/2: 1; expected a time later than the one before it, 1\n");
  CHECK(spring_faults(begin + "{\"t\": [0, 1], \"y\": [0]}") ==
        "s.json:2:77: error: /springs/0/stiffness/y: [0]; expected one entry for each time, that "
        "is 2\n");
  CHECK(spring_faults("\"at\": {\"near\": [0, 0, 0]}, \"to\": {\"t\": [0, 1], \"points\": [[0, 0, 0]]}") ==
        "s.json:2:58: error: /springs/0/to/points: [[0, 0, 0]]; expected one entry for each time, that is "
        "2\n");
}

TEST_CASE("all errors are shown at once, in the order of the file") {
  const std::string text = faults(R"({
  "parts": [
    {"name": "a", "shape": {"type": "sphere", "radius": -1}, "mas": 1, "density": 1},
    {"name": "b", "shape": {"type": "spere"}, "mass": 1, "name": "c"}
  ],
  "sprigs": []
})");
  CHECK(text ==
        "s.json:3:57: error: /parts/0/shape/radius: -1; expected a number > 0 (m)\n"
        "s.json:3:62: error: /parts/0/mas: unknown key; did you mean \"mass\"?\n"
        "s.json:4:37: error: /parts/1/shape/type: \"spere\"; expected one of \"sphere\", \"superellipsoid\"; "
        "did you mean "
        "\"sphere\"?\n"
        "s.json:4:58: error: /parts/1/name: key given twice; the first is at line 4, column 6\n"
        "s.json:6:3: error: /sprigs: unknown key; did you mean \"springs\"?\n");
}

TEST_CASE("a large number of errors is cut short") {
  std::string text = "{\"parts\": [], \"springs\": [";
  for (int i = 0; i < 200000; ++i) text += "{\"a\": 1},";
  text += "{}]}";
  const std::string shown = faults(text);
  CHECK(std::count(shown.begin(), shown.end(), '\n') == 21);
  CHECK(shown.find("... and ") != std::string::npos);
}

TEST_CASE("errors of --set values name the option") {
  Diagnostics diagnostics;
  JsonDocument document = JsonDocument::parse("s.json", kGood, diagnostics);
  document.set("/solver/method=rk5", diagnostics);
  document.set("/parts/1/masss=3", diagnostics);
  document.set("/springs/0/stiffness=2*y", diagnostics);
  document.set("/springs/1/stiffness=\"2*x\"", diagnostics);
  validate(document, scene(), diagnostics);
  CHECK(diagnostics.text() ==
        "--set /parts/1/masss: error: /parts/1/masss: unknown key; did you mean \"mass\"?\n"
        "--set /springs/0/stiffness: error: /springs/0/stiffness: \"2*y\"; unknown name \"y\"; did you mean "
        "\"t\"?\n"
        "--set /springs/1/stiffness: error: /springs/1/stiffness: \"2*x\"; unknown name \"x\"; did you mean "
        "\"t\"?\n"
        "--set /solver/method: error: /solver/method: \"rk5\"; expected one of \"euler\", \"rk4\"; did you "
        "mean \"rk4\"?\n");
}

TEST_CASE("readers provide values and defaults") {
  Diagnostics diagnostics;
  const JsonDocument document = JsonDocument::parse("s.json", kGood, diagnostics);
  validate(document, scene(), diagnostics);
  REQUIRE(diagnostics.errors() == 0);
  const Reader root(document.root(), scene());
  CHECK(root.text("title") == "t");
  const std::vector<Reader> parts = root.objects("parts");
  REQUIRE(parts.size() == 2);
  const Reader& arm = parts[0];
  CHECK(arm.text("name") == "arm");
  CHECK(arm.number("density") == 1000);
  CHECK_FALSE(arm.given("mass"));
  CHECK(arm.find("mass") == nullptr);
  CHECK_THROWS_AS(arm.number("mass"), std::logic_error);
  CHECK_THROWS_AS(arm.number("weight"), std::logic_error);
  CHECK_FALSE(arm.boolean("fixed"));
  CHECK(parts[1].boolean("fixed"));
  CHECK(arm.vector3("position") == pliant::Vec3<double>::Zero());
  const Reader shape = arm.object("shape");
  CHECK(shape.name() == "superellipsoid");
  CHECK(shape.vector3("a") == pliant::Vec3<double>(1, 2, 3));
  CHECK(shape.numbers("a") == std::vector<double>{1, 2, 3});
  CHECK(shape.number("eps1") == 0.5);
  CHECK(shape.number("eps2") == 1);
  const std::vector<Reader> chain = arm.objects("deformations");
  REQUIRE(chain.size() == 3);
  CHECK(chain[0].name() == "taper");
  CHECK(chain[1].name() == "twist");
  CHECK(chain[2].number("tx") == 0);
  CHECK(parts[1].objects("deformations").empty());

  const std::vector<Reader> springs = root.objects("springs");
  const auto to = springs[0].time_vector("to").at(0.5);
  CHECK(to[0].v == 0);
  CHECK(to[1].d == Approx(std::cos(0.5)));
  CHECK(to[2].v == Approx(1));
  CHECK(springs[0].time_function("stiffness").value(0) == 100);
  CHECK(springs[1].time_function("stiffness").value(0) == 0);
  CHECK(springs[2].time_vector("to").value(1)[0] == Approx(1));
  const auto by_u = read_material_point(springs[0].at("at"));
  CHECK((by_u.form == MaterialPointValue::Form::kCoordinates && by_u.x == pliant::Vec3<double>(0.1, 0.2, 1)));
  const auto by_direction = read_material_point(springs[1].at("at"));
  CHECK((by_direction.form == MaterialPointValue::Form::kDirection && by_direction.w == 0.5));
  CHECK(read_material_point(springs[2].at("at")).form == MaterialPointValue::Form::kNear);
  CHECK(springs[2].object("at").name() == "point_near");
  CHECK(root.object("solver").integer("substeps") == 3);

  const JsonDocument bare = JsonDocument::parse("s.json", "{\"parts\": []}", diagnostics);
  const Reader defaults = Reader(bare.root(), scene()).object("solver");
  CHECK(defaults.text("method") == "rk4");
  CHECK(defaults.integer("substeps") == 1);
  CHECK(defaults.at("step").string() == "auto");
  CHECK(Reader(bare.root(), scene()).objects("springs").empty());
}

TEST_CASE("a single value can be checked against its own type") {
  Diagnostics diagnostics;
  const JsonDocument document = JsonDocument::parse("s.json", kGood, diagnostics);
  const Record names{
      "sphere_parameters", "Parameters of a sphere.", {optional("radius", number(above(0), "m"), "Radius.")}};
  validate(document, *document.at("/parts/0/parameters"), record(names), diagnostics);
  CHECK(diagnostics.text() ==
        "s.json:7:21: error: /parts/0/parameters/a1: unknown key; expected one of \"radius\"\n"
        "s.json:7:30: error: /parts/0/parameters/taper.tx: unknown key; expected one of \"radius\"\n");
}

TEST_CASE("key frames may have end rates") {
  Diagnostics diagnostics;
  const JsonDocument d =
      JsonDocument::parse("k", "{\"t\": [0, 1], \"y\": [0, 1], \"end_rates\": [0, 0]}", diagnostics);
  const auto f = pliant::read_time_function(d.root());
  CHECK(f.at(0.5).v == Approx(0.5));
  CHECK(f.at(0.5).d == Approx(1.5));
  CHECK(f.at(1).d == Approx(0).margin(1e-15));
}

TEST_CASE("invalid declarations are errors of the program") {
  CHECK_THROWS_AS(optional("a", number(unbounded(), "m"), "A.", "[1,"), std::logic_error);
  CHECK_THROWS_AS(required("a", number(unbounded(), "m"), "A.", "nan"), std::logic_error);
  const Record twice{
      "r",
      "R.",
      {optional("a", boolean().defined_as("d"), "A."), optional("b", text().defined_as("d"), "B.")}};
  CHECK_THROWS_AS(schema_json(twice), std::logic_error);
}

namespace {

/// Returns whether the JSON Schema accepts the text.
bool valid(const std::string& text) {
  static const pliant::test::SchemaValidator judge(schema_json(scene()));
  return judge.accepts(nlohmann::json::parse(text));
}

/// Checks that every property in a schema has a description, and adds the number of properties to
/// `properties`.
void check_described(const nlohmann::json& node, int* properties) {
  if (node.is_object() && node.contains("properties") && node["properties"].is_object()) {
    for (const auto& [key, property] : node["properties"].items()) {
      INFO(key);
      CHECK(property.contains("description"));
      ++*properties;
    }
  }
  for (const auto& child : node) {
    if (child.is_structured()) check_described(child, properties);
  }
}

}  // namespace

TEST_CASE("the JSON Schema describes every key") {
  const std::string text = schema_json(scene());
  const auto schema = nlohmann::json::parse(text);
  int properties = 0;
  check_described(schema, &properties);
  CHECK(properties > 35);
  CHECK(schema["$schema"] == "http://json-schema.org/draft-07/schema#");
  const auto& part = schema["definitions"]["part"];
  CHECK(part["properties"]["density"]["description"] == "Mass per rest volume. Unit: kg/m^3.");
  CHECK(part["properties"]["density"]["exclusiveMinimum"] == 0);
  CHECK(part["properties"]["fixed"]["default"] == false);
  CHECK(part["properties"]["shape"]["oneOf"][1]["properties"]["eps1"]["description"] ==
        "Exponent from pole to pole. Dimensionless.");
  CHECK(part["properties"]["shape"]["oneOf"][1]["properties"]["eps1"]["maximum"] == 5);
  CHECK(schema["definitions"].contains("time_function"));
  CHECK(schema_json(scene()) == text);
}

TEST_CASE("the JSON Schema and the records agree") {
  CHECK(valid(kGood));
  CHECK(valid("{\"parts\": []}"));
  const std::vector<std::string> bad = {
      "[]",
      "{}",
      "{\"parts\": {}}",
      "{\"parts\": [3]}",
      "{\"parts\": [], \"sprigs\": []}",
      "{\"parts\": [], \"title\": \"\"}",
      "{\"parts\": [], \"solver\": {\"method\": \"rk5\"}}",
      "{\"parts\": [], \"solver\": {\"substeps\": 0}}",
      "{\"parts\": [], \"solver\": {\"substeps\": 2.5}}",
      "{\"parts\": [], \"solver\": {\"step\": 0}}",
      "{\"parts\": [], \"solver\": {\"step\": \"fast\"}}",
      "{\"parts\": [{\"name\": \"\", \"shape\": {\"type\": \"sphere\"}, \"mass\": 1}]}",
      "{\"parts\": [{\"name\": \"a/b\", \"shape\": {\"type\": \"sphere\"}, \"mass\": 1}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"spere\"}, \"mass\": 1}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"radius\": 1}, \"mass\": 1}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\", \"eps1\": 1}, \"mass\": 1}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}, \"mass\": 1, \"density\": 1}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}, \"mass\": 0}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}, \"mass\": 1, \"position\": [0, "
      "1]}]}",
      "{\"parts\": [{\"name\": \"a\", \"shape\": {\"type\": \"sphere\"}, \"mass\": 1, \"parameters\": "
      "{\"r\": []}}]}",
      "{\"parts\": [], \"springs\": [{\"part\": \"a\", \"at\": {\"u\": 0}, \"to\": [0, 0, 0]}]}",
      "{\"parts\": [], \"springs\": [{\"part\": \"a\", \"at\": {\"near\": [0, 0, 0]}, \"to\": [0, 0, "
      "true]}]}",
  };
  for (const std::string& text : bad) {
    INFO(text);
    CHECK_FALSE(valid(text));
    CHECK_FALSE(faults(text).empty());
  }
}

}  // namespace schema_test
