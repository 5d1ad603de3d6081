// layout.json names every column of every table, and stays short for many parts.
// I55 in the name of a test is a row of the table in tests/README.md.
#include <pliant/io/layout.h>

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "catch.h"
#include "layout_names.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/io/format/npy.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/run_files.h>
#include <pliant/part/local/local_laws.h>

namespace layout_test {

using namespace pliant;

namespace {

/// Returns the number of columns of a table.
std::size_t columns_in(const std::filesystem::path& table) {
  const NpyReader reader(table);
  return reader.columns() == kNpyVector ? 1 : static_cast<std::size_t>(reader.columns());
}

/// Returns a scene of `count` free spheres. Every second sphere has a dynamic radius. The names of the
/// spheres contain * and #, which are placeholders in the patterns of layout.json.
std::unique_ptr<Scene> spheres(int count) {
  auto scene = std::make_unique<Scene>();
  scene->end = 0.02;
  scene->step = 0.01;
  scene->frame_rate = 50;
  scene->integrator = "rk4";
  for (int i = 0; i < count; ++i) {
    Part& part = scene->body.add(make_part("s*#[0]" + std::to_string(i), "sphere", {}, 1000));
    part.rest({{"r", 0.1}});
    if (i % 2 == 0) part.stiffness({{"r", 1e5}});
  }
  scene->appearance.resize(scene->body.parts().size());
  return scene;
}

void run_in(const std::filesystem::path& folder, Scene& scene) {
  Progress silent;
  RunOptions options;
  options.folder = folder;
  Run run(scene, options, silent);
  REQUIRE(run.simulate());
}

}  // namespace

TEST_CASE("the layout names every column") {
  const NewFolder folder;
  const auto scene = pulled_scene();
  scene->contacts = true;
  run_in(folder / "r", *scene);
  const std::string text = bytes_of(folder / "r" / kLayoutFile);
  const nlohmann::json layout = nlohmann::json::parse(text);
  int tables = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "r")) {
    if (entry.path().extension() != ".npy") continue;
    ++tables;
    const std::string table = entry.path().filename().string();
    INFO(table);
    REQUIRE(layout.at("tables").contains(table));
    CHECK(layout_names(text, table.c_str()).size() == columns_in(entry.path()));
  }
  CHECK(tables >= 8);
  const Model model(scene->body);
  std::vector<std::string> coordinates, velocities;
  for (int i = 0; i < model.n_q(); ++i) coordinates.push_back(model.coordinate_name(i));
  for (int i = 0; i < model.n_v(); ++i) velocities.push_back(model.velocity_name(i));
  CHECK(layout_names(text, kCoordinatesFile) == coordinates);
  CHECK(layout_names(text, kVelocitiesFile) == velocities);
  const std::vector<std::string> modes = layout_names(text, kModesFile);
  CHECK(std::count(modes.begin(), modes.end(), "limit.blob.taper.tx") == 1);
  CHECK(modes[modes.size() - 2] == "joint.leash");
  const auto& first = layout.at("kinds").at(0).at("coordinates").at(0);
  CHECK(first.at("name") == "*.c.x");
  CHECK(first.at("unit") == "m");
  CHECK(layout.at("kinds").at(0).at("velocities").at(3).at("unit") == "rad/s");
  CHECK(layout.at("parts").at(2) == nlohmann::json({"wall", layout.at("parts").at(2).at(1), -1, -1}));
  CHECK(layout.at("parts").at(1).at(2) == model.parts()[1].q0);
  CHECK(layout.at("frames").at("rate") == 50);
}

TEST_CASE("the layout has the columns of a kind of part once, and a line for each part") {
  const NewFolder folder;
  const auto scene = spheres(400);
  run_in(folder / "r", *scene);
  const std::string text = bytes_of(folder / "r" / kLayoutFile);
  CHECK(nlohmann::json::parse(text).at("kinds").size() == 2);
  CHECK(text.size() < 20000 + 400 * 40);
  const Model model(scene->body);
  CHECK(layout_names(text, kCoordinatesFile).back() == model.coordinate_name(model.n_q() - 1));
  CHECK(Recording(folder / "r", model).rows() == 2);
}

TEST_CASE("the layout gives the columns of nodes as series (entries with a count)") {
  const NewFolder folder;
  auto scene = std::make_unique<Scene>();
  Part& soft = scene->body.add(make_part("soft", "sphere", {}, 1000));
  soft.rest({{"r", 0.1}});
  LocalSettings settings;
  settings.resolution = 4;
  settings.energies = {local_law("neo_hookean", {1e5, 0.3})};
  soft.deform_locally(std::move(settings));
  const Model model(scene->body);
  write_layout(folder.path, model, FrameSchedule(1, 0.1, 10), {});
  const std::string text = bytes_of(folder / kLayoutFile);
  const std::vector<std::string> names = layout_names(text, kCoordinatesFile);
  REQUIRE(static_cast<int>(names.size()) == model.n_q());
  for (int i = 0; i < model.n_q(); ++i)
    if (names[static_cast<std::size_t>(i)] != model.coordinate_name(i))
      FAIL(names[static_cast<std::size_t>(i)]);
  CHECK(text.size() < 15000);
  CHECK_NOTHROW(compare_layout(folder.path, model));
}

TEST_CASE("I55: a layout of another version or of another scene is refused") {
  const NewFolder folder;
  const auto scene = spheres(3), other = spheres(3);
  const Model model(scene->body);
  write_layout(folder.path, model, FrameSchedule(1, 0.1, 10), {});
  const std::string text = bytes_of(folder / kLayoutFile);
  nlohmann::json old = nlohmann::json::parse(text);
  old["version"] = 4;
  set_bytes(folder / kLayoutFile, old.dump());
  CHECK_THROWS_WITH(compare_layout(folder.path, model),
                    test::has_text("has version 4, and this program reads version 5 only"));
  set_bytes(folder / kLayoutFile, text);
  CHECK_NOTHROW(compare_layout(folder.path, model));
  other->body.parts()[1]->stiffness({{"r", 1e5}});
  CHECK_THROWS_WITH(compare_layout(folder.path, Model(other->body)),
                    test::has_text("column 15 of q.npy is s*#[0]2.c.x, and in this scene s*#[0]1.r"));
  CHECK_THROWS_WITH(compare_layout(folder.path, Model(spheres(4)->body)),
                    test::has_text("q.npy has 23 columns, and this scene needs 30"));
}

TEST_CASE("I55: a damaged layout with too many columns is refused at once") {
  const NewFolder folder;
  const auto scene = spheres(1);
  const Model model(scene->body);
  write_layout(folder.path, model, FrameSchedule(1, 0.1, 10), {});
  nlohmann::json layout = nlohmann::json::parse(bytes_of(folder / kLayoutFile));
  nlohmann::json& columns = layout.at("kinds").at(0).at("coordinates");
  columns.push_back({{"name", "*.d#"}, {"count", 2000000000}});
  set_bytes(folder / kLayoutFile, layout.dump());
  CHECK_THROWS_WITH(compare_layout(folder.path, model),
                    test::has_text("q.npy has more than the " + std::to_string(model.n_q()) + " columns"));
}

TEST_CASE("I55: run.json of another version is refused, with the version and what to do") {
  const NewFolder folder;
  const std::filesystem::path file = folder / kRunFile;
  write_run_record(file, RunRecord());
  CHECK_NOTHROW(read_run_record(file));
  nlohmann::ordered_json old = nlohmann::ordered_json::parse(bytes_of(file));
  old["version"] = 4;
  set_bytes(file, old.dump(2));
  CHECK_THROWS_WITH(read_run_record(file),
                    test::has_text("run.json is damaged: its checksum does not match"));
  old.erase("check");
  set_bytes(file, old.dump(2));
  CHECK_THROWS_WITH(read_run_record(file),
                    test::has_text("has version 4, and this program reads version 5 only"));
  old.erase("version");
  old.at("progress").erase("durable_states");
  set_bytes(file, old.dump(2));
  CHECK_THROWS_WITH(read_run_record(file),
                    test::has_text("has no version, and this program reads version 5 only. Read the run with "
                                   "the program that wrote it"));
}

}  // namespace layout_test
