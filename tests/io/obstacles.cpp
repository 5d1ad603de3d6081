// A run stores the meshes of its obstacles beside its scene. Obstacles and visible planes are among the
// surfaces of a frame.
#include "catch.h"

#include <cstring>
#include <memory>

#include <pliant/io/format/obj.h>
#include <pliant/io/format/ply.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/run_files.h>
#include <pliant/scene/mesh_file.h>
#include <pliant/scene/read_scene.h>

#include "io/new_folder.h"

namespace obstacles_test {

using namespace pliant;

namespace {

/// Returns the text of a scene with a ball and three obstacles: a roof (mesh of two triangles), a plate that
/// is removed at 0.05 s, and a plate that is not visible.
std::string scene_text() {
  return R"json({
    "time": {"end": 0.1, "step": 0.005},
    "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.1}, "position": [0, 0, 1]}],
    "contact": {"obstacles": [
      {"name": "a roof", "mesh": "meshes/roof.obj", "scale": 0.1, "position": [0, 0, 0.3], "color": "#ff0000"},
      {"name": "plate", "half_extents": [1, 2], "off": 0.05},
      {"name": "hidden", "half_extents": [1, 2], "visible": false}
    ]}
  })json";
}

/// Writes roof.json and the mesh of its roof. third: coordinates of the third vertex of the mesh. Coordinates
/// with many digits show whether all bits are kept.
void write_scene(const NewFolder& folder, const std::string& third) {
  std::filesystem::create_directories(folder / "meshes");
  set_bytes(folder / "meshes/roof.obj",
            "v 0.1 0.2 1.23456789e-7\nv 3.1 0.3 0\nv " + third + "\nv 4.7 6.1 0\nf 1 2 4\nf 1 4 3\n");
  set_bytes(folder / "roof.json", scene_text());
}

std::unique_ptr<Scene> read(const std::filesystem::path& file, MeshFiles files = MeshFiles::as_named) {
  Diagnostics diagnostics;
  return read_scene(file.string(), {}, diagnostics, {}, files);
}

}  // namespace

TEST_CASE("a run keeps the meshes of its obstacles, and reads them back to the last bit") {
  const NewFolder folder;
  write_scene(folder, "0.1234567 2.1 0.3");
  const std::unique_ptr<Scene> scene = read(folder / "roof.json");
  Progress quiet;
  RunOptions options;
  options.folder = folder / "run";
  options.scene_file = (folder / "roof.json").string();
  {
    Run run(*scene, options, quiet);
    REQUIRE(run.simulate());
    run.finish(RunRecord::Status::complete);
  }
  const std::string kept = recorded_mesh_name("a roof");
  CHECK(is_run_file(kept));
  CHECK_FALSE(is_run_file("roof.ply"));
  CHECK_FALSE(std::filesystem::exists(folder / "run" / recorded_mesh_name("plate")));
  std::filesystem::remove_all(folder / "meshes");  // a run needs only its own folder
  const std::unique_ptr<Scene> again = read(folder / "run" / kSceneFile, MeshFiles::of_a_run);
  CHECK(again->hash == scene->hash);
  REQUIRE(again->body.contact.obstacles.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(again->body.contact.obstacles[k].vertices == scene->body.contact.obstacles[k].vertices);
    CHECK(again->body.contact.obstacles[k].triangles == scene->body.contact.obstacles[k].triangles);
  }
  write_scene(folder, "0.1234567 2.2 0.3");
  CHECK(read(folder / "roof.json")->hash != scene->hash);
}

TEST_CASE("obstacles are among the surfaces of a frame while they are active, open ones with both sides") {
  const NewFolder folder;
  write_scene(folder, "0.1234567 2.1 0.3");
  const std::unique_ptr<Scene> scene = read(folder / "roof.json");
  const Simulation simulation(scene->body, scene->integrator);
  FrameMeshes frame(*scene, simulation.model());
  State state = simulation.state();
  const std::vector<NamedMesh>& meshes = frame.at(state);
  REQUIRE(meshes.size() == 3);
  CHECK(meshes[1].name == "a roof");
  CHECK(meshes[1].color == Color{1, 0, 0});
  CHECK(meshes[1].mesh.triangles.cols() == 4);
  CHECK(meshes[1].mesh.x.cols() == 4);
  CHECK((meshes[1].mesh.x.col(3) - Vec3<double>(0.47, 0.61, 0.3)).norm() < 1e-15);
  CHECK((meshes[1].mesh.normals.col(0) + meshes[1].mesh.normals.col(2)).norm() == 0);
  CHECK(meshes[2].name == "plate");
  CHECK(meshes[2].mesh.triangles.cols() == 4);
  CHECK(frame.triangles() == 48 * 64 + 8);
  CHECK(frame.bounds(state).contains(Vec3<double>(0.47, 0.61, 0.2999)));
  CHECK_THAT(obj_text(meshes), test::has_text("g a_roof\n"));
  state.start = 0.06;
  CHECK(frame.at(state).size() == 2);
  state.start = 0;
  CHECK(frame.at(state).size() == 3);
}

TEST_CASE("visible planes are among the surfaces of a frame while they are active, centred at their point") {
  Diagnostics diagnostics;
  const std::unique_ptr<Scene> scene = parse_scene("s.json", R"json({
    "time": {"end": 1},
    "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.1}, "position": [0, 0, 1]}],
    "contact": {"planes": [
      {"name": "floor", "shown": {"width": 4, "height": 2}},
      {"name": "unseen", "point": [0, 0, -9]},
      {"name": "swatter", "point": ["t - 2", 1, 0.5], "normal": [3, 0, 0], "on": 0.5, "off": 0.9,
       "shown": {"width": 2, "height": 1, "color": "#ff0000"}}
    ]}
  })json",
                                                   {}, diagnostics);
  const Simulation simulation(scene->body, scene->integrator);
  FrameMeshes frame(*scene, simulation.model());
  State state = simulation.state();
  REQUIRE(frame.at(state).size() == 2);
  CHECK(frame.at(state)[1].name == "floor");
  CHECK(frame.bounds(state).min() == Eigen::Vector3d(-2, -1, 0));
  CHECK(frame.triangles() == 48 * 64 + 8);
  state.start = 0.75;
  const std::vector<NamedMesh>& meshes = frame.at(state);
  REQUIRE(meshes.size() == 3);
  const NamedMesh& swatter = meshes[2];
  CHECK(swatter.name == "swatter");
  CHECK(swatter.color == Color{1, 0, 0});
  CHECK(swatter.mesh.x.rowwise().minCoeff() == Eigen::Vector3d(-1.25, 0, 0));
  CHECK(swatter.mesh.x.rowwise().maxCoeff() == Eigen::Vector3d(-1.25, 2, 1));
  CHECK(swatter.mesh.normals.col(0) == Eigen::Vector3d::UnitX());
  CHECK(swatter.mesh.normals.col(2) == -Eigen::Vector3d::UnitX());
  // In a PLY file, which has one normal for each vertex, the normals of planes are those of the front side.
  const std::string bytes = ply_bytes({swatter}), mark = "end_header\n";
  float normal[3];
  std::memcpy(normal, bytes.data() + bytes.find(mark) + mark.size() + 3 * sizeof(double), sizeof normal);
  CHECK(Eigen::Vector3f(normal[0], normal[1], normal[2]) == Eigen::Vector3f::UnitX());
  CHECK(frame.bounds(state).min() == Eigen::Vector3d(-2, -1, 0));
  CHECK(frame.bounds(state).max() == Eigen::Vector3d(2, 2, 1.1));
  state.start = 0.9;
  CHECK(frame.at(state).size() == 2);
}

}  // namespace obstacles_test
