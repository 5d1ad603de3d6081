// contacts.csv contains the contacts and their forces. joint_impulses.csv contains the impulses on joints. A
// resumed run writes identical files.
#include <pliant/io/run/run.h>

#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "catch.h"
#include "new_folder.h"

#include <pliant/io/run/run_files.h>
#include <pliant/part/registry.h>

namespace contacts_test {

using namespace pliant;
namespace fs = std::filesystem;

namespace {

/// Returns a scene with a box at rest on a floor. Two balls, which a weld connects, fall onto the floor.
std::unique_ptr<Scene> falling_scene() {
  auto scene = std::make_unique<Scene>();
  scene->end = 0.4;
  scene->step = 2e-3;
  scene->frame_rate = 50;
  scene->integrator = "rk4";
  scene->contacts = true;
  MultiBody& body = scene->body;
  body.add(make_part("box", "box", {}, 1000))
      .rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.1}})
      .place({0, 0, 0.1});
  Part& left = body.add(make_part("ball, left", "sphere", {}, 1000)).rest({{"r", 0.1}}).place({1, 0, 0.3});
  Part& right = body.add(make_part("right", "sphere", {}, 1000)).rest({{"r", 0.05}}).place({1.15, 0, 0.3});
  body.weld("rod", point(left, 0, 0), point(right, 0, kPi));
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  scene->appearance.resize(3);
  scene->hash = 5;
  return scene;
}

/// Runs a scene in a folder; stop_after: number of steps, or -1 for a run to the end. Returns whether the run
/// reached its end.
bool run(Scene& scene, const fs::path& folder, Existing existing = Existing::refuse, long stop_after = -1) {
  Progress silent;
  RunOptions options;
  options.folder = folder;
  options.existing = existing;
  options.threads = 1;
  long steps = 0;
  if (stop_after >= 0) options.stop = [&] { return steps++ >= stop_after; };
  Run session(scene, options, silent);
  const bool complete = session.simulate();
  session.finish(complete ? RunRecord::Status::complete : RunRecord::Status::stopped);
  return complete;
}

/// Returns the cells of a CSV file, row by row.
std::vector<std::vector<std::string>> table_of(const fs::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(bytes_of(file));
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        cells.emplace_back();
      else
        cells.back() += c;
    }
    rows.push_back(cells);
  }
  return rows;
}

constexpr const char* kTables[] = {kContactsFile, kContactsTable, kJointImpulsesFile, kJointImpulsesTable};

}  // namespace

TEST_CASE("contacts are recorded with names, positions and forces", "[contact]") {
  const NewFolder folder;
  auto scene = falling_scene();
  REQUIRE(run(*scene, folder / "out"));
  const auto contacts = table_of(folder / "out" / kContactsTable);
  REQUIRE(contacts.size() > 20);
  const auto& header = contacts.front();
  REQUIRE(header.size() == contact_columns().size());
  CHECK(header[1] == "a");
  double weight = 0, lowest = 1, t_last = 0;
  bool ball = false;
  for (std::size_t i = 1; i < contacts.size(); ++i) {
    const auto& row = contacts[i];
    REQUIRE(row.size() == header.size());
    CHECK(row[2] == "floor");
    ball = ball || row[1] == "ball, left";
    const double t = std::stod(row[0]);
    CHECK(t >= t_last);
    t_last = t;
    CHECK(std::stod(row[8]) == 1);
    if (row[1] != "box") continue;
    lowest = std::min(lowest, std::abs(std::stod(row[3])));
    CHECK(std::stod(row[16]) < 1e-9);
    if (t > 0.399) weight += std::stod(row[15]);
  }
  CHECK(ball);
  CHECK(lowest == Approx(0.2));  // the box stands on its corners
  CHECK(weight == Approx(9.81 * scene->body.parts()[0]->total_mass()));
  CHECK(t_last == Approx(0.4));
  const auto impulses = table_of(folder / "out" / kJointImpulsesTable);
  REQUIRE(impulses.size() > 1);
  CHECK(impulses[1][1] == "rod");
  CHECK(impulses[1].size() == joint_impulse_columns().size());

  const auto layout = nlohmann::json::parse(bytes_of(folder / "out" / kLayoutFile));
  for (const char* table : kTables) CHECK(layout.at("tables").contains(table));
  const auto record = nlohmann::json::parse(bytes_of(folder / "out" / kRunFile));
  for (const char* table : kTables) CHECK(record.dump().find(table) != std::string::npos);
  // With Existing::force a run replaces the files of an earlier run.
  REQUIRE(run(*falling_scene(), folder / "out", Existing::force));
  scene->contacts = false;
  REQUIRE(run(*scene, folder / "without"));
  for (const char* table : kTables) CHECK_FALSE(fs::exists(folder / "without" / table));
}

/// Checks that at each recorded time the sum of the contact forces on the box equals its weight.
void check_weight(Scene& scene) {
  const NewFolder folder;
  REQUIRE(run(scene, folder / "out"));
  std::map<double, double> force_of_time;  // sum of the upward contact forces on the box, N
  for (const auto& row : table_of(folder / "out" / kContactsTable))
    if (row[1] == "box") force_of_time[std::stod(row[0])] += std::stod(row[15]);
  REQUIRE(force_of_time.size() > 3);
  const double weight = 9.81 * scene.body.parts()[0]->total_mass();
  for (const auto& [t, force] : force_of_time) {
    CAPTURE(t);
    CHECK(force == Approx(weight));
  }
}

TEST_CASE("with error control, the recorded forces on a part at rest equal its weight", "[contact]") {
  auto scene = falling_scene();
  scene->integrator = "dop853";
  scene->tolerance = 1e-4;
  check_weight(*scene);
}

TEST_CASE("a joint that engages within a step does not change the recorded forces of other parts",
          "[contact]") {
  auto scene = falling_scene();
  // The weld engages within the step from 0.098 s to 0.1 s. The state at 0.1 s is recorded.
  scene->body.joints().front()->during(0.0998);
  check_weight(*scene);
}

TEST_CASE("a resumed run records identical contacts", "[contact]") {
  const NewFolder folder;
  REQUIRE(run(*falling_scene(), folder / "unbroken"));
  for (const long stop : {0L, 7L, 100L, 133L}) {
    const fs::path out = folder / std::to_string(stop);
    CHECK_FALSE(run(*falling_scene(), out, Existing::refuse, stop));
    REQUIRE(run(*falling_scene(), out, Existing::resume));
    for (const char* table : kTables) CHECK(bytes_of(out / table) == bytes_of(folder / "unbroken" / table));
  }
}

TEST_CASE("the recorded contacts of a state are the rows of its time") {
  const NewFolder folder;
  const auto scene = falling_scene();
  run(*scene, folder / "r");
  const auto rows = table_of(folder / "r" / kContactsTable);
  const std::optional<RecordedContacts> contacts = RecordedContacts::open(folder / "r");
  REQUIRE(contacts);
  std::map<double, std::vector<Vec3<double>>> forces;  // of each time, in the order of the table
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto number = [&](std::size_t k) { return std::strtod(rows[i][k].c_str(), nullptr); };
    forces[number(0)].push_back({number(13), number(14), number(15)});
  }
  REQUIRE(forces.size() > 5);
  for (const auto& [t, expected] : forces) {
    const std::vector<RecordedContacts::Force> found = contacts->at(t);
    REQUIRE(found.size() == expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k].force == expected[k]);
  }
  CHECK(contacts->at(1e9).empty());
  CHECK_FALSE(RecordedContacts::open(folder.path));
}

}  // namespace contacts_test
