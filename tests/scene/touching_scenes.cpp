// The scenes with contact run to their end with their own step. After each step no overlap exceeds a
// thousandth of the size of the smaller part. Joints that have closed stay closed in every impact. The scenes
// that show figures of the paper move as in these figures.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/contact/contact_stepping.h>
#include <pliant/io/run/contact_notes.h>
#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"
#include "io/new_folder.h"

namespace touching_scenes_test {

namespace fs = std::filesystem;
using pliant::JointMode;
using pliant::PartModel;
using pliant::Simulation;
using pliant::Vec3;
using pliant::VecX;

namespace {

/// Names of the scenes with contact in scenes/: rigid parts, soft parts, and parts on joints.
const std::vector<std::string> kRigid{"bowl", "cradle", "dominoes", "roly_poly", "slope", "tower"},
    kSoft{"balloons", "springboard"}, kJointed{"dragonfly", "snowman"};

/// Runs a scene to its end, and checks the overlaps after every step. after_step: called with the simulation
/// after every step. Returns the number of times at which a contact starts after 50 ms without any contact;
/// the first contact is always counted.
template <class AfterStep>
int run_file(const std::string& file, const std::vector<std::string>& overrides, AfterStep&& after_step) {
  CAPTURE(file);
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::read_scene(file, overrides, diagnostics);
  Simulation simulation(scene->body, scene->integrator, 1, scene->tolerance);
  REQUIRE(simulation.contact() != nullptr);
  int contact_starts = 0;
  double last = -1;
  while (simulation.time() < scene->end - 0.5 * scene->step) {
    simulation.step(scene->step);
    CAPTURE(simulation.time());
    REQUIRE(pliant::deepest_share(simulation) <= 1e-3);
    if (!simulation.contact()->contacts().empty()) {
      contact_starts += simulation.time() - last > 0.05;
      last = simulation.time();
    }
    after_step(simulation);
  }
  CHECK(simulation.time() == Approx(scene->end));
  return contact_starts;
}
template <class AfterStep>
int run_scene(const std::string& name, AfterStep&& after_step) {
  return run_file(std::string(PLIANT_SCENES) + "/" + name + ".json", {}, std::forward<AfterStep>(after_step));
}
int number_of(const Simulation& simulation, const std::string& part) {
  const std::vector<PartModel>& parts = simulation.model().parts();
  const auto at = std::find_if(parts.begin(), parts.end(),
                               [&](const PartModel& each) { return each.part->name() == part; });
  REQUIRE(at != parts.end());
  return static_cast<int>(at - parts.begin());
}
const PartModel& model_of(const Simulation& simulation, const std::string& part) {
  return simulation.model().parts()[static_cast<std::size_t>(number_of(simulation, part))];
}
/// Returns the dynamic global parameters of a part, followed by the coordinates of its local deformation.
VecX<double> deformation(const Simulation& simulation, const std::string& part) {
  const PartModel& model = model_of(simulation, part);
  return simulation.state().q.segment(model.q0 + 7, model.n_s + model.n_d());
}
/// Returns the bend angle of a part, rad. Throws std::out_of_range if this parameter is not dynamic.
double bend(const Simulation& simulation, const std::string& part) {
  const PartModel& model = model_of(simulation, part);
  for (int k = 0; k < model.n_s; ++k)
    if (model.part->parameters().moving(k).name == "bend.angle")
      return simulation.state().q[model.q0 + 7 + k];
  throw std::out_of_range(part + " has no bend");
}
double height(const Simulation& simulation, const std::string& part) {
  return simulation.state().q[model_of(simulation, part).q0 + 2];
}
/// The smallest and the largest of the noted numbers.
struct Extent {
  double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
  void note(double x) {
    smallest = std::min(smallest, x);
    largest = std::max(largest, x);
  }
  double width() const { return largest - smallest; }
};

}  // namespace

TEST_CASE("every scene with contact is in one of the lists of this file") {
  std::vector<std::string> run = kRigid, with_contact;
  for (const std::vector<std::string>& more : {kSoft, kJointed})
    run.insert(run.end(), more.begin(), more.end());
  for (const fs::directory_entry& entry : fs::directory_iterator(PLIANT_SCENES)) {
    const fs::path& path = entry.path();
    if (path.extension() != ".json" || path.filename() == "pliant-scene.schema.json") continue;
    if (nlohmann::json::parse(std::ifstream(path)).contains("contact"))
      with_contact.push_back(path.stem().string());
  }
  std::sort(run.begin(), run.end());
  std::sort(with_contact.begin(), with_contact.end());
  CHECK(with_contact == run);
}

TEST_CASE("rigid parts of the scenes never overlap by more than a thousandth of their size",
          "[contact][long]") {
  for (const std::string& name : kRigid) CHECK(run_scene(name, [](Simulation&) {}) > 0);
}

TEST_CASE("the eggs of roly_poly come to rest where their centres of mass are lowest", "[contact][long]") {
  // The centre of mass of an egg with the density 1 + k z is at z_m = k a3^2 / 5. At the angle theta between
  // the axis of the egg and the vertical, its height is sqrt(a1^2 + (a3^2 - a1^2) cos^2 theta) + z_m cos
  // theta.
  const double a1 = 0.2, a3 = 0.25, z_m = -3.8 * a3 * a3 / 5, excess = a3 * a3 - a1 * a1,
               slant = a1 / std::sqrt(excess * excess / (z_m * z_m) - excess);
  Vec3<double> up;
  run_scene("roly_poly", [&](const Simulation& simulation) {
    for (int i = 0; i < 3; ++i)
      up[i] = (simulation.model().orientation(simulation.state(), i) * Vec3<double>::UnitZ()).z();
  });
  CAPTURE(up, slant);
  CHECK(up[0] == Approx(0).margin(1e-3));
  CHECK(up[1] == Approx(slant).margin(1e-3));
  CHECK(up[2] == Approx(1).margin(1e-3));
}

TEST_CASE("all of a hundred ellipsoids from pour.sh fall into the bowl", "[contact][long]") {
  const NewFolder place;
  const fs::path scenes = PLIANT_SCENES, file = place / "pour.json";
  fs::copy(scenes / "bowl.obj", place.path);
  REQUIRE(std::system(
              ("bash '" + (scenes / "pour.sh").string() + "' 100 > '" + file.string() + "'").c_str()) == 0);
  Extent height;
  double out = 0;
  run_file(file.string(), {"/time/end=1"}, [&](Simulation& simulation) {
    height = Extent();
    out = 0;
    for (const PartModel& part : simulation.model().parts()) {
      const Eigen::Vector3d c = simulation.state().q.segment<3>(part.q0);
      height.note(c.z());
      out = std::max(out, c.head<2>().norm());
    }
  });
  const double scale = std::cbrt(100 / 30.0);  // scale of the mesh of the bowl, as in scenes/pour.sh
  CHECK(height.smallest > 0);
  CHECK(height.largest < 0.55 * scale);
  CHECK(out < 0.55 * scale);
}

TEST_CASE("balloons swing, collide, deform and come to rest without deep overlaps", "[contact][long]") {
  // A deformation less than kImpact (s) after the last time without contact is a dent of an impact. kLast:
  // start of the last second, s.
  constexpr double kImpact = 0.05, kLast = 12.8;
  double max_kinetic = 0, kinetic = 0, fastest = 0, dent = 0, last_free = 0, contact_gain = 0, error = 0;
  VecX<double> undeformed;  // deformation() of the middle balloon at the last time without contact
  const int contact_starts = run_scene("balloons", [&](Simulation& simulation) {
    const double t = simulation.time();
    const VecX<double> now = deformation(simulation, "balloon5");
    if (simulation.contact()->contacts().empty()) {
      undeformed = now;
      last_free = t;
    } else if (t < last_free + kImpact) {
      dent = std::max(dent, (now - undeformed).lpNorm<Eigen::Infinity>());
    }
    const pliant::Ledger ledger = simulation.ledger();
    kinetic = ledger.kinetic;
    max_kinetic = std::max(max_kinetic, kinetic);
    contact_gain = std::max(contact_gain, ledger.work[static_cast<int>(pliant::Work::contact)]);
    error = std::max(error, std::abs(ledger.balance));
    if (t < kLast) return;
    for (const PartModel& part : simulation.model().parts())
      fastest = std::max(fastest, simulation.state().v.segment<3>(part.v0).norm());
  });
  CHECK(contact_starts >= 5);
  CHECK(dent > 0.01);  // m; the radius is 0.1 m
  CHECK(kinetic < 1e-3 * max_kinetic);
  CHECK(fastest < 0.025);  // m/s, during the last second; initially 1.5 m/s
  // Inelastic contact adds no energy beyond the error of the method.
  CAPTURE(contact_gain, error);
  CHECK(contact_gain <= error);
  CHECK(error <= 0.1 * max_kinetic);  // the method is of first order
}

TEST_CASE("the springboard throws up the ball on its end, and all parts deform", "[contact][long]") {
  Extent bend_range;
  double start = 0, highest = 0, dent = 0;
  VecX<double> before;
  const int contact_starts = run_scene("springboard", [&](Simulation& simulation) {
    if (before.size() == 0) {
      start = height(simulation, "red");
      before = deformation(simulation, "yellow");
    }
    highest = std::max(highest, height(simulation, "red"));
    bend_range.note(bend(simulation, "board"));
    dent = std::max(dent, (deformation(simulation, "yellow") - before).lpNorm<Eigen::Infinity>());
  });
  CHECK(contact_starts >= 2);
  CHECK(highest > start + 0.25);  // 0.25 m is about twice the radius of the ball
  CHECK(bend_range.width() > 0.02);
  CHECK(dent > 0.02);
}

TEST_CASE(
    "the dragonfly flaps its wings, which bend, and flies; the impact bends its body and dents its membrane",
    "[contact][long]") {
  const std::vector<std::string> wings{"left_fore", "right_fore", "left_hind", "right_hind"};
  std::vector<Extent> flaps(wings.size()), bend_range(wings.size());
  Extent before_impact, after_impact;
  double max_speed = 0, dent_before = 0, dent_after = 0;
  Eigen::Vector3d take_off = Eigen::Vector3d::Zero(), before = take_off;
  std::int64_t evaluations = 0, most_in_a_step = 0;
  run_scene("dragonfly", [&](Simulation& simulation) {
    const double t = simulation.time();
    const std::int64_t now = simulation.step_counters().evaluations;
    most_in_a_step = std::max(most_in_a_step, now - std::exchange(evaluations, now));
    const Eigen::Vector3d place =
        simulation.model().position(simulation.state(), number_of(simulation, "body"));
    if (t < 5) take_off = place;
    if (t < 8) before = place;
    if (t > 5) {
      double& largest = t < 8 ? dent_before : dent_after;
      const Eigen::Index n_d = model_of(simulation, "body").n_d();
      largest = std::max(largest, deformation(simulation, "body").tail(n_d).lpNorm<Eigen::Infinity>());
    }
    if (t > 5 && t < 8) {
      before_impact.note(bend(simulation, "body"));
      for (std::size_t i = 0; i < wings.size(); ++i) {
        auto turn = [&](const std::string& part) {
          return simulation.model().orientation(simulation.state(), number_of(simulation, part));
        };
        // The angle (rad) of the wing about the long axis (z) of the body, from the y axis or the -y axis.
        const Eigen::Vector3d along = turn("body").conjugate() * (turn(wings[i]) * Eigen::Vector3d::UnitZ());
        flaps[i].note(std::atan2(along.x(), std::abs(along.y())));
        bend_range[i].note(bend(simulation, wings[i]));
      }
    }
    if (t > 8) after_impact.note(bend(simulation, "body"));
    if (t > 8.6) max_speed = std::max(max_speed, simulation.state().v[model_of(simulation, "body").v0]);
  });
  for (std::size_t i = 0; i < wings.size(); ++i) {
    CAPTURE(wings[i]);
    CHECK(flaps[i].width() > 0.5);
    CHECK(bend_range[i].width() > 0.2);
  }
  CHECK(before.z() > take_off.z() + 0.2);  // the air on its wings drives the dragonfly up and ahead
  CHECK(before.x() > take_off.x() + 0.2);
  CHECK(std::abs(before.y()) < 0.3);  // the controller keeps its course
  CHECK(after_impact.largest > before_impact.largest + 0.1);
  CHECK(dent_after > 2 * dent_before);
  CHECK(max_speed > 0.5);
  CHECK(most_in_a_step <= 80);  // impacts of a wing that stays at the plane are not located again in the step
}

TEST_CASE("closed joints of the dragonfly and the snowman stay closed in every impact",
          "[contact][joints][long]") {
  for (const std::string& name : kJointed) {
    std::vector<JointMode> modes;
    std::vector<bool> from_start, closed;
    const int contact_starts = run_scene(name, [&](Simulation& simulation) {
      modes = simulation.state().joints;
      closed.resize(modes.size());
      if (from_start.empty())
        for (const JointMode mode : modes) from_start.push_back(mode != JointMode::off);
      for (std::size_t j = 0; j < modes.size(); ++j) {
        closed[j] = modes[j] == JointMode::closed || (closed[j] && modes[j] != JointMode::off);
        if (!closed[j]) continue;
        INFO(simulation.model().joints()[j].joint->name());
        REQUIRE(modes[j] == JointMode::closed);
        // The scenes need a gap below 1e-6 of the length of a part. The largest observed gap is 5e-14 m.
        REQUIRE(simulation.model().gap(simulation.state(), static_cast<int>(j)) <= 1e-12);
      }
    });
    CAPTURE(name, contact_starts);
    CHECK(contact_starts >= (name == "snowman" ? 6 : 1));
    CHECK(std::count(from_start.begin(), from_start.end(), true) >= (name == "snowman" ? 12 : 4));
    for (const JointMode mode : modes) CHECK(mode != JointMode::closing);
  }
}

}  // namespace touching_scenes_test
