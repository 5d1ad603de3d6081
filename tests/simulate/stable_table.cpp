// The predicted largest stable step for scenes of every kind: a small disturbance of the start stays bounded
// at 0.995 times the predicted step. It grows at 1.11 times the predicted step if StableStep::uncounted is
// empty.
// N20 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <pliant/body/joints/all_joints.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/simulate/stable_step.h>

#include "motion.h"

namespace stable_table_test {

using namespace pliant;

namespace {

using Build = std::function<void(MultiBody&)>;

struct Scene {
  std::string name;
  Build build;
};

/// Name and constants of a law of local deformation.
struct Law {
  std::string name;
  std::vector<double> numbers;
};

LocalSettings settings_of(const std::vector<Law>& laws, double alpha, double beta, int resolution = 1) {
  LocalSettings settings;
  settings.resolution = resolution;
  settings.alpha = alpha;
  settings.beta = beta;
  for (const Law& law : laws) settings.energies.push_back(local_law(law.name, law.numbers));
  return settings;
}

/// Returns a scene with one solid of a shape that deforms locally.
Scene solid(const std::string& shape, const Law& law, double alpha, double beta, int resolution = 1) {
  return {
      shape + ", " + law.name + ", alpha " + std::to_string(alpha) + ", beta " + std::to_string(beta),
      [=](MultiBody& body) {
        test::add(body, "soft", shape, {}, 1000).deform_locally(settings_of({law}, alpha, beta, resolution));
      }};
}

/// Returns a scene with one shell of a shape that deforms locally.
Scene shell(const std::string& shape, const std::vector<Law>& laws, double alpha, double beta) {
  return {"shell " + shape + ", " + laws.front().name + ", alpha " + std::to_string(alpha) + ", beta " +
              std::to_string(beta),
          [=](MultiBody& body) {
            Part& part = test::add(body, "skin", shape, {}, 1);
            part.make_shell();
            part.deform_locally(settings_of(laws, alpha, beta));
          }};
}

/// Returns a scene with one solid that has one dynamic size (a semi-axis or a radius). alpha: 1/s; beta: s;
/// drag: 1/s.
Scene breathing(const std::string& shape, const std::string& parameter, double alpha, double beta,
                double drag) {
  return {
      shape + " with " + parameter + ", drag " + std::to_string(drag), [=](MultiBody& body) {
        test::add(body, "solid", shape, {}, 1000).stiffness({{parameter, 2e4}}).damping(alpha, beta, drag);
      }};
}

/// Adds a ball between two stretched springs without rest length, which pull at its poles. The rotation of
/// the ball is stiff, too, because the springs are long in comparison with the ball.
void stretched(MultiBody& body, double reach, double stiffness, double damping) {
  auto& ball = body.add<Primitive<Sphere>>("ball", 1000);
  ball.rest({{"r", 0.1}});
  body.spring("above", world(0, 0, reach), point(ball, material_at(kPi / 2, 0)), stiffness, damping);
  body.spring("below", world(0, 0, -reach), point(ball, material_at(-kPi / 2, 0)), stiffness, damping);
}

std::vector<Scene> solids() {
  std::vector<Scene> all;
  const Law elastic{"elastic", {1e5, 0.3}}, rubber{"neo_hookean", {1e5, 0.45}},
      corotated{"corotated", {2e5, 0.2}}, st_venant{"st_venant_kirchhoff", {5e4, 0.3}};
  int number = 0;
  for (const char* shape : {"box", "capsule", "cone", "cylinder", "ellipsoid", "sphere", "superellipsoid",
                            "superellipsoid_radial", "supertoroid"}) {
    const Law& law = number % 3 == 0 ? elastic : number % 3 == 1 ? rubber : corotated;
    all.push_back(solid(shape, law, number % 2 == 0 ? 0 : 3, number % 4 == 3 ? 0.02 : 0,
                        std::string(shape) == "cone" ? 3 : 1));
    ++number;
  }
  all.push_back(solid("box", st_venant, 0, 0.03, 2));
  all.push_back(solid("ellipsoid", rubber, 0, 0.03, 2));
  all.push_back(solid("sphere", corotated, 0, 1e-3, 2));
  all.push_back(solid("cylinder", elastic, 0, 1e-2, 2));
  return all;
}

std::vector<Scene> shells() {
  std::vector<Scene> all;
  const std::vector<Law> linear{{"membrane", {1e5, 0.3, 0.002}}, {"bending", {1e5, 0.3, 0.01}}},
      large{{"neo_hookean_membrane", {1e5, 0.3, 0.002}}},
      st_venant{{"st_venant_kirchhoff_membrane", {1e5, 0.3, 0.002}}, {"folding", {1e5, 0.3, 0.01}}};
  int number = 0;
  for (const char* shape : {"box", "capsule", "cone", "cylinder", "ellipsoid", "sphere", "superellipsoid"}) {
    const std::vector<Law>& laws = number % 3 == 0 ? linear : number % 3 == 1 ? large : st_venant;
    all.push_back(shell(shape, laws, number % 2 == 0 ? 0 : 2, number % 4 == 2 ? 0.01 : 0));
    ++number;
  }
  return all;
}

std::vector<Scene> parameters() {
  std::vector<Scene> all{breathing("box", "a1", 0, 0, 0),         breathing("sphere", "r", 5, 0, 0),
                         breathing("cylinder", "a3", 0, 0.02, 0), breathing("capsule", "r", 0, 0, 20),
                         breathing("ellipsoid", "a2", 1, 0.1, 1), breathing("superellipsoid", "a1", 0, 0, 0)};
  all.push_back(
      {"tapered, twisted, bent solid", [](MultiBody& body) {
         Part& part = test::add(body, "solid", "box", {"taper", "twist", "bend"}, 1000);
         part.stiffness({{"a1", 3e4}, {"taper.tx", 300}, {"twist.angle", 200}, {"bend.angle", 500}});
         part.damping(0, 1e-3, 0);
       }});
  all.push_back({"ellipsoid with parameters and nodes", [](MultiBody& body) {
                   Part& part = test::add(body, "soft", "ellipsoid", {}, 1000);
                   part.stiffness({{"a1", 1e4}, {"a3", 2e4}});
                   part.deform_locally(settings_of({{"neo_hookean", {1e5, 0.3}}}, 0, 1e-3));
                 }});
  return all;
}

std::vector<Scene> springs_and_joints() {
  std::vector<Scene> all;
  all.push_back({"short stretched springs", [](MultiBody& body) { stretched(body, 0.3, 1000, 0); }});
  all.push_back({"long stretched springs", [](MultiBody& body) { stretched(body, 10, 1000, 0); }});
  all.push_back({"damped stretched springs", [](MultiBody& body) { stretched(body, 10, 1000, 2); }});
  all.push_back({"two balls on a spring with a rest length", [](MultiBody& body) {
                   auto& a = body.add<Primitive<Sphere>>("a", 1000);
                   auto& b = body.add<Primitive<Sphere>>("b", 300);
                   b.place({3, 0, 0});
                   body.spring("tie", point(a, 0, 0), point(b, 0, kPi), 5e4, 10, 1);
                 }});
  all.push_back({"springs at nodes", [](MultiBody& body) {
                   Part& part = test::add(body, "soft", "ellipsoid", {}, 1000);
                   part.deform_locally(settings_of({{"elastic", {1e4, 0.3}}}, 0, 0));
                   body.spring("right", world(2, 0, 0), point(part, 0, 0), 1e5, 10, 1);
                   body.spring("left", world(-2, 0, 0), point(part, 0, kPi), 1e5, 10, 1);
                 }});
  all.push_back({"hanging chain", [](MultiBody& body) {
                   body.gravity = {0, 0, -9.81};
                   const Part* above = nullptr;
                   for (int i = 0; i < 6; ++i) {
                     auto& link = body.add<Primitive<Ellipsoid>>("link" + std::to_string(i), 1000);
                     link.rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.2}}).place({0, 0, -0.2 - 0.4 * i});
                     body.ball("joint" + std::to_string(i),
                               above == nullptr ? world(0, 0, 0) : point(*above, -kPi / 2, 0),
                               point(link, kPi / 2, 0));
                     above = &link;
                   }
                 }});
  all.push_back({"soft part on a joint", [](MultiBody& body) {
                   Part& part = test::add(body, "soft", "box", {}, 1000);
                   part.deform_locally(settings_of({{"elastic", {1e5, 0.3}}}, 0, 1e-3));
                   body.ball("pin", world(0, 0, 0), point(part, 0, 0, 0));
                 }});
  all.push_back({"two soft parts on a spring, with drag", [](MultiBody& body) {
                   Part& a = test::add(body, "a", "box", {}, 1000);
                   Part& b = test::add(body, "b", "sphere", {}, 500);
                   b.place({4, 0, 0});
                   for (Part* part : {&a, &b})
                     part->deform_locally(settings_of({{"neo_hookean", {5e4, 0.3}}}, 0, 0));
                   a.damping(0, 0, 5);
                   body.spring("tie", point(a, 0, 0), point(b, 0, kPi), 2e4, 20, 2);
                 }});
  all.push_back({"modes on springs", [](MultiBody& body) {
                   Part& part = test::add(body, "soft", "ellipsoid", {}, 1000);
                   LocalSettings settings = settings_of({{"elastic", {1e5, 0.3}}}, 0, 1e-3);
                   settings.basis = LocalSettings::Basis::polynomial;
                   settings.degree = 2;
                   part.deform_locally(settings);
                   body.spring("right", world(2, 0, 0), point(part, 0, 0), 1e5, 10, 1);
                   body.spring("left", world(-2, 0, 0), point(part, 0, kPi), 1e5, 10, 1);
                 }});
  all.push_back({"gas in a shell", [](MultiBody& body) {
                   Part& part = test::add(body, "ball", "sphere", {}, 0.5);
                   part.make_shell();
                   part.deform_locally(settings_of(
                       {{"neo_hookean_membrane", {1e5, 0.3, 1e-3}}, {"gas", {1e5, 1.4, 1e5}}}, 0, 0));
                 }});
  all.push_back({"bar on a pin between stretched springs", [](MultiBody& body) {
                   auto& bar = body.add<Primitive<Capsule>>("bar", 1000);
                   body.ball("pin", world(0, 0, 0), point(bar, 0, 0, 0));
                   body.spring("up", world(0, 0, 4), point(bar, material_at(kPi / 2, 0)), 2e3, 1);
                   body.spring("down", world(0, 0, -4), point(bar, material_at(-kPi / 2, 0)), 2e3, 1);
                 }});
  all.push_back({"hinged bar on a spring", [](MultiBody& body) {
                   auto& bar = body.add<Primitive<Box>>("bar", 1000);
                   bar.rest({{"a1", 1}, {"a2", 0.1}, {"a3", 0.1}});
                   body.ball("pin", world(-1, 0, 0), point(bar, material_at(0, kPi)));
                   body.spring("tie", world(1, 0, 3), point(bar, material_at(0, 0)), 1e4, 5);
                   body.spring("other", world(1, 0, -3), point(bar, material_at(0, 0)), 1e4, 5);
                 }});
  return all;
}

/// Returns whether a disturbance of the velocities by 1e-9 stays bounded in 600 steps of h (s).
bool bounded(const Build& build, const char* method, double h) {
  MultiBody body;
  body.gravity.setZero();
  build(body);
  Simulation simulation(body, method);
  State state = simulation.state();
  for (Eigen::Index i = 0; i < state.v.size(); ++i)
    state.v[i] += 1e-9 * std::sin(1.0 + 7.0 * static_cast<double>(i));
  const double start = state.v.norm();
  simulation.set_state(state);
  try {
    for (int i = 0; i < 600; ++i) {
      simulation.step(h);
      if (!(simulation.state().v.norm() <= 1e3 * start)) return false;
    }
  } catch (const StepFailure&) {
    return false;
  }
  return true;
}

/// Checks the predicted step of each scene, see the top of this file.
void check_table(const std::vector<Scene>& scenes) {
  for (const Scene& scene : scenes)
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      MultiBody body;
      body.gravity.setZero();
      scene.build(body);
      const StableStep predicted = stable_step(Simulation(body, method));
      INFO(scene.name << ", " << method << ": predicted " << predicted.step << " s, limited by "
                      << predicted.limit << "; " << predicted.uncounted);
      REQUIRE(std::isfinite(predicted.step));
      // At the limit of semi-implicit Euler an undamped oscillation grows linearly in time.
      CHECK(bounded(scene.build, method, 0.995 * predicted.step));
      if (predicted.uncounted.empty())
        CHECK_FALSE(bounded(scene.build, method, 1.11 * predicted.step));
      else
        CHECK(scene.name == "modes on springs");
    }
}

}  // namespace

TEST_CASE("N20: stable steps of solids that deform locally", "[stable][long]") {
  check_table(solids());
}

TEST_CASE("N20: stable steps of shells", "[stable][long]") {
  check_table(shells());
}

TEST_CASE("N20: stable steps of parts with dynamic parameters", "[stable][long]") {
  check_table(parameters());
}

TEST_CASE("N20: stable steps of parts on springs and joints", "[stable][long]") {
  check_table(springs_and_joints());
}

}  // namespace stable_table_test
