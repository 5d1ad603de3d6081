// trajectory.csv has a header and numbers in full precision. For a scene with more than a hundred parts it
// has only the time, tracks and totals (energies, works, balance and momenta), unless the scene requests all
// parts.
#include <pliant/io/trajectory.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "catch.h"
#include "layout_names.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/io/run/run.h>
#include <pliant/io/run/run_files.h>
#include <pliant/scene/read_scene.h>

namespace trajectory_test {

using namespace pliant;

namespace {

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found{""};
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      found.back() += line[++i];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      found.emplace_back();
    else
      found.back() += line[i];
  }
  return found;
}

}  // namespace

TEST_CASE("the table contains the recorded numbers exactly, with their names") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  Progress silent;
  RunOptions options;
  options.folder = folder / "r";
  Run run(*scene, options, silent);
  REQUIRE(run.simulate());
  const Recording recording = run.recording();
  const Model& model = run.simulation().model();

  std::istringstream table(bytes_of(folder / "r" / kTrajectoryFile));
  std::string line;
  std::getline(table, line);
  const std::vector<std::string> header = cells(line);
  CHECK(layout_names(bytes_of(folder / "r" / kLayoutFile), kTrajectoryFile) == header);
  const auto column = [&](const std::string& name) {
    const auto at = std::find(header.begin(), header.end(), name);
    REQUIRE(at != header.end());
    return static_cast<std::size_t>(at - header.begin());
  };
  CHECK(header.front() == "t");
  column("blob.com.x");
  column("rider, \"heavy\".com.z");  // the frame of the rider is not at its centre of mass
  CHECK(std::find(header.begin(), header.end(), "wall.c.x") == header.end());

  double worst = 0;
  for (std::int64_t row = 0; row < recording.rows(); ++row) {
    REQUIRE(std::getline(table, line));
    const std::vector<std::string> text = cells(line);
    REQUIRE(text.size() == header.size());
    std::vector<double> numbers;
    for (const std::string& cell : text) numbers.push_back(std::strtod(cell.c_str(), nullptr));
    const State state = recording.state(row);
    CHECK(numbers[0] == state.time());
    for (int i = 0; i < model.n_q(); ++i) CHECK(numbers[column(model.coordinate_name(i))] == state.q[i]);
    for (int i = 0; i < model.n_v(); ++i) CHECK(numbers[column(model.velocity_name(i))] == state.v[i]);
    for (int i = 0; i < kWorks; ++i)
      CHECK(numbers[column(std::string("work.") + kWorkNames[static_cast<std::size_t>(i)])] == state.work[i]);
    const Vec3<double> grip = model.world_point(state, 0, scene->tracks[0].point.material);
    CHECK(numbers[column("track.grip.y")] == grip[1]);
    const double sum = numbers[column("energy.kinetic")] + numbers[column("energy.gravity")] +
                       numbers[column("energy.elastic")] + numbers[column("energy.springs")];
    CHECK(numbers[column("energy.total")] == Approx(sum).epsilon(1e-14));
    worst = std::max(worst, std::abs(numbers[column("balance")]));
  }
  CHECK_FALSE(std::getline(table, line));
  CHECK(worst == run.record().max_balance_error);
  CHECK(worst < 1e-3);
}

TEST_CASE("a joint's force is the force on its first side, in the world frame, and its gap is closed") {
  // One sphere hangs at rest from a ball joint at its top, and another sphere swings about a ball joint. The
  // test runs with and without rotated frames, and with the spheres on the first or on the second side.
  const double g = 9.81, r = 0.1, mass = 3;
  const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity(),
                           turned = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized();
  for (const Eigen::Quaterniond& R : {upright, turned})
    for (const bool first : {false, true}) {
      Scene scene;
      scene.body.gravity = {0, 0, -g};
      Part& bob = scene.body.add(make_part("bob", "sphere", {}, 1000));
      bob.rest({{"r", r}}).mass(mass).place({0.4, 0, -r}, R);
      Part& swung = scene.body.add(make_part("swung", "sphere", {}, 1000));
      swung.rest({{"r", r}}).mass(mass).place({2 + r, 0, 0}, R);
      // Returns the material point on the surface of a sphere in this world direction from its centre.
      const auto on = [&](const Part& part, const Vec3<double>& direction) {
        const Vec3<double> at = R.conjugate() * direction;
        return point(part, std::asin(at[2]), std::atan2(at[1], at[0]));
      };
      const Point top = on(bob, {0, 0, 1}), side = on(swung, {-1, 0, 0});
      if (first) {
        scene.body.ball("hold", top, world(0.4, 0, 0));
        scene.body.ball("swing", side, world(2, 0, 0));
      } else {
        scene.body.ball("hold", world(0.4, 0, 0), top);
        scene.body.ball("swing", world(2, 0, 0), side);
      }
      scene.appearance.resize(2);
      Simulation simulation(scene.body, "rk4");
      TrajectoryTable table(scene, simulation);
      const std::vector<Column> columns = all_columns(table.columns(), simulation.model());
      std::vector<double> numbers;
      const auto number = [&](const std::string& name) {
        for (std::size_t i = 0; i < columns.size(); ++i)
          if (columns[i].name == name) return numbers[i];
        FAIL(name);
        return 0.0;
      };
      const auto force = [&](const std::string& joint) {
        return Vec3<double>(number(joint + ".force.x"), number(joint + ".force.y"),
                            number(joint + ".force.z"));
      };
      const double sign = first ? 1 : -1;  // the force on the bob points upwards
      for (int i = 0; i < 200; ++i) {
        if (i > 0) simulation.step(5e-3);
        table.row(simulation.state(), numbers);
        INFO(i << " " << first);
        REQUIRE((force("joint.hold") - sign * Vec3<double>(0, 0, mass * g)).norm() <= 1e-11 * mass * g);
        REQUIRE(number("joint.hold.gap") <= 1e-12);
        REQUIRE(number("joint.swing.gap") <= 1e-12);
        // The joint force on the swinging sphere is m (c_ddot - g): c_ddot is the acceleration of its centre,
        // g the gravity vector. along, across: unit vectors from the joint to the centre, and in the
        // direction of the swing; I = 7/5 m r^2: moment of inertia about the joint.
        const Vec3<double> along = (simulation.state().q.segment<3>(7) - Vec3<double>(2, 0, 0)) / r,
                           across(along[2], 0, -along[0]);
        const double inertia = 1.4 * r, acceleration = across[2] * -g / inertia,  // I / (m r)
            rate = simulation.state().v.segment<3>(6).squaredNorm() / r;
        const Vec3<double> needed = mass * (r * acceleration * across - rate * along + Vec3<double>(0, 0, g));
        REQUIRE((force("joint.swing") - sign * needed).norm() <= 1e-10 * mass * g);
      }
    }
}

TEST_CASE("for more than a hundred parts only totals are written, unless the scene requests every part") {
  Scene scene;
  for (int i = 0; i < 101; ++i) scene.body.add(make_part("p" + std::to_string(i), "sphere", {}, 1));
  scene.appearance.resize(101);
  Simulation simulation(scene.body);
  TrajectoryTable table(scene, simulation);
  CHECK(all_columns(table.columns(), simulation.model()).size() == 1 + 5 + kWorks + 1 + 6);
  std::vector<double> numbers;
  table.row(simulation.state(), numbers);
  CHECK(numbers.size() == all_columns(table.columns(), simulation.model()).size());

  scene.every_part = true;
  TrajectoryTable whole(scene, simulation);
  CHECK(all_columns(whole.columns(), simulation.model()).size() == 1 + 101 * 13 + 5 + kWorks + 1 + 6);
  numbers.clear();
  whole.row(simulation.state(), numbers);
  CHECK(numbers.size() == all_columns(whole.columns(), simulation.model()).size());
}

TEST_CASE("the table has the value of each sensor at each recorded state") {
  const NewFolder folder;
  Diagnostics diagnostics;
  const auto scene = parse_scene("s.json", R"json({"gravity": [0, 0, 0], "time": {"end": 1, "step": 0.01},
    "output": {"frame_rate": 10},
    "parts": [{"name": "ball", "shape": "sphere", "position": [1, 0, 0], "velocity": [0, 0, 4]}],
    "sensors": [{"name": "height", "value": "ball.z"}, {"name": "twice the height", "value": "2 * height + t"}]})json",
                                 {}, diagnostics);
  Progress silent;
  RunOptions options;
  options.folder = folder / "r";
  Run run(*scene, options, silent);
  REQUIRE(run.simulate());
  std::istringstream table(bytes_of(folder / "r" / kTrajectoryFile));
  std::string line;
  std::getline(table, line);
  const std::vector<std::string> header = cells(line);
  const auto column = [&](const std::string& name) {
    const auto at = std::find(header.begin(), header.end(), name);
    REQUIRE(at != header.end());
    return static_cast<std::size_t>(at - header.begin());
  };
  int rows = 0;
  for (; std::getline(table, line); ++rows) {
    const std::vector<std::string> text = cells(line);
    const auto number = [&](const std::string& name) {
      return std::strtod(text[column(name)].c_str(), nullptr);
    };
    CHECK(number("sensor.height") == Approx(4 * number("t")).margin(1e-12));
    CHECK(number("sensor.twice the height") == Approx(9 * number("t")).margin(1e-12));
  }
  CHECK(rows == 11);
}

}  // namespace trajectory_test
