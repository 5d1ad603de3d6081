// The scenes of figures 1, 3 and 6 of the paper are driven by gravity, forces and springs alone, and have the
// results that their descriptions state.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/body/placed_point.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"

namespace figures_test {

using namespace pliant;
using Json = nlohmann::json;

namespace {

Json document(const std::string& name) {
  return Json::parse(std::ifstream(std::string(PLIANT_SCENES) + "/" + name + ".json"));
}

/// Simulates a scene until a time (s), and calls after_step(simulation) after each step.
template <class AfterStep>
void run(const std::string& name, double until, AfterStep&& after_step) {
  Diagnostics diagnostics;
  const auto scene = read_scene(std::string(PLIANT_SCENES) + "/" + name + ".json", {}, diagnostics);
  Simulation simulation(scene->body, scene->integrator);
  while (simulation.time() < until - 0.5 * scene->step) {
    simulation.step(scene->step);
    after_step(simulation);
  }
}

/// Returns the dynamic parameters of a part by their names.
std::map<std::string, double> parameters(const Simulation& simulation, const std::string& part) {
  std::map<std::string, double> values;
  for (const PartModel& model : simulation.model().parts())
    if (model.part->name() == part)
      for (int k = 0; k < model.n_s; ++k)
        values[model.part->parameters().moving(k).name] = simulation.state().q[model.q0 + 7 + k];
  REQUIRE_FALSE(values.empty());
  return values;
}

}  // namespace

TEST_CASE("gravity, forces and springs alone drive the scenes of figures 1, 3 and 6") {
  for (const char* name : {"pull", "gallery", "balloons", "springboard"}) {
    CAPTURE(name);
    const Json scene = document(name);
    for (const char* key : {"motion", "torques", "surface_forces", "body_forces", "sensors"})
      CHECK_FALSE(scene.contains(key));
    if (scene.contains("gravity"))
      for (const Json& g : scene.at("gravity")) CHECK(g.is_number());
    for (const Json& plane : scene.value("contact", Json::object()).value("planes", Json::array()))
      for (const char* key : {"point", "normal"})
        for (const Json& x : plane.value(key, Json::array())) CHECK(x.is_number());
    for (const Json& part : scene.at("parts")) {
      CAPTURE(part.at("name"));
      CHECK_FALSE(part.contains("motion"));
      for (const auto& [key, value] : part.at("parameters").items()) {
        CAPTURE(key);
        if (!value.is_object()) {
          CHECK(value.is_number());
          continue;
        }
        CHECK(value.at("rest").is_number());
        CHECK_FALSE(value.contains("drive"));
        CHECK_FALSE(value.contains("initial"));
      }
    }
    for (const Json& joint : scene.value("joints", Json::array())) {
      CHECK(joint.at("type") != "weld");
      CHECK_FALSE(joint.contains("drive"));
      for (const Json& end : {joint.at("from"), joint.at("to")})
        if (end.contains("world"))
          for (const Json& x : end.at("world")) CHECK(x.is_number());
    }
  }
}

TEST_CASE("all bodies of the gallery start as the same supersphere") {
  const Json scene = document("gallery");
  const std::map<std::string, double> rest{{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.5}, {"eps1", 1}, {"eps2", 1}};
  for (const Json& part : scene.at("parts"))
    for (const auto& [key, value] : part.at("parameters").items()) {
      CAPTURE(part.at("name"), key);
      CHECK(value.at("rest") == (rest.count(key) > 0 ? rest.at(key) : 0));
      CHECK(value.at("stiffness") > 0);
    }
}

TEST_CASE("forces mould the superspheres of the gallery, and hold their shapes", "[long]") {
  using Values = std::map<std::string, double>;
  const std::vector<std::pair<std::string, Values>> moulded{
      {"squared", {{"a1", 0.63}, {"a2", 0.63}, {"a3", 0.63}, {"eps1", 0.44}, {"eps2", 0.59}}},
      {"pinched", {{"a1", 0.46}, {"a2", 0.46}, {"a3", 0.47}, {"eps1", 1.53}, {"eps2", 1.39}}},
      {"tapered", {{"a3", 0.60}, {"eps1", 0.59}, {"taper.tx", -0.55}, {"taper.ty", -0.55}}},
      {"bent", {{"a1", 0.23}, {"a2", 0.36}, {"a3", 0.84}, {"bend.angle", 0.85}}},
      {"twisted", {{"a1", 0.77}, {"a2", 0.30}, {"a3", 0.88}, {"twist.angle", 1.47}}},
      {"sheared", {{"eps1", 0.51}, {"eps2", 0.65}, {"shear.sx", 0.51}, {"shear.sy", 0}}},
      {"corkscrew", {{"a1", 0.76}, {"a2", 0.30}, {"taper.tx", -0.55}, {"twist.angle", 1.47}}},
      {"supersphere", {{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.5}}}};
  std::map<std::string, Values> at_3, at_4;
  double balance = 0;
  run("gallery", 4, [&](Simulation& simulation) {
    balance = std::max(balance, std::abs(simulation.ledger().balance));
    auto& now = simulation.time() < 3.01 ? at_3 : at_4;
    if (std::abs(simulation.time() - 3) < 0.01 || simulation.time() > 3.99)
      for (const auto& [part, values] : moulded) now[part] = parameters(simulation, part);
  });
  for (const auto& [part, values] : moulded)
    for (const auto& [name, value] : values) {
      CAPTURE(part, name);
      CHECK(at_4.at(part).at(name) == Approx(value).margin(0.03));
      CHECK(std::abs(at_4.at(part).at(name) - at_3.at(part).at(name)) < 0.05);
    }
  CHECK(balance < 0.01);  // J; the springs and forces do more than 1000 J of work
}

TEST_CASE("the spring of fig. 1 raises a bulge of the membrane, stretches the part and shears it", "[long]") {
  double bulge = 0, elsewhere = 0, a3 = 0, shear = 0;
  run("pull", 1.8, [&](Simulation& simulation) {
    const PartModel& blob = simulation.model().parts()[0];
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3>> d(
        simulation.state().q.data() + blob.q0 + 7 + blob.n_s, blob.n_d() / 3, 3);
    const VecX<double> far = d.rowwise().norm();
    if (far.maxCoeff() > bulge) {
      bulge = far.maxCoeff();
      elsewhere = std::sqrt(far.squaredNorm() / static_cast<double>(far.size()));
    }
    const auto now = parameters(simulation, "blob");
    a3 = std::max(a3, now.at("a3"));
    shear = std::max(shear, now.at("shear.sx"));
  });
  CHECK(bulge > 0.3);  // m; the rest values of the sizes are 0.3 m and 0.45 m
  CHECK(elsewhere < 0.25 * bulge);
  CHECK(a3 > 1.25 * 0.45);
  CHECK(shear > 0.3);
}

TEST_CASE("the balloons have different strings, angles and first impacts, and no string stretches",
          "[contact][long]") {
  const Json scene = document("balloons");
  std::vector<double> lengths, angles;
  for (const Json& joint : scene.at("joints")) {
    CHECK(joint.at("type") == "string");
    lengths.push_back(joint.at("length"));
  }
  for (const Json& part : scene.at("parts")) angles.push_back(part.at("orientation").at("angle"));
  REQUIRE(lengths.size() == 9);
  for (std::vector<double>* numbers : {&lengths, &angles}) {
    std::vector<double> sorted = *numbers;
    std::sort(sorted.begin(), sorted.end());
    CHECK(std::unique(sorted.begin(), sorted.end()) == sorted.end());
  }
  std::map<std::pair<int, int>, double> met;  // time of the first contact of two balloons, s
  double longest = 0, shortest = 1;           // lengths of strings / largest lengths
  run("balloons", 2.5, [&](Simulation& simulation) {
    const Model& model = simulation.model();
    for (std::size_t j = 0; j < lengths.size(); ++j) {
      const std::vector<Point>& ends = model.joints()[j].joint->points();
      const double now = (PlacedPoint(model, ends[0]).at(simulation.state()) -
                          PlacedPoint(model, ends[1]).at(simulation.state()))
                             .norm() /
                         lengths[j];
      longest = std::max(longest, now);
      shortest = std::min(shortest, now);
    }
    for (const Contact& contact : simulation.contact()->contacts())
      met.emplace(std::minmax({contact.a.part, contact.b.part}), simulation.time());
  });
  CHECK(longest < 1 + 1e-9);
  CHECK(shortest < 0.999);  // strings become slack
  std::vector<double> times;
  for (const auto& [pair, time] : met) times.push_back(time);
  std::sort(times.begin(), times.end());
  const auto close = [](double a, double b) { return b - a < 0.02; };
  CHECK(met.size() >= 8);
  CHECK(std::unique(times.begin(), times.end(), close) - times.begin() >= 5);
}

}  // namespace figures_test
