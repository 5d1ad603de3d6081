// Bodies fall on meshes from files: a mirrored box is solid, and edges far from the origin are
// accurate.
#include "catch.h"

#include <memory>
#include <string>

#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "io/new_folder.h"
#include "mesh_samples.h"

namespace mesh_obstacles_test {

using namespace pliant;

namespace {

/// A scene with a mesh file, after a simulation until a given time (s) with rk4 and steps of 2 ms.
class FinishedRun {
 public:
  FinishedRun(const std::string& mesh_name, const std::string& mesh, const std::string& scene, double until) {
    set_bytes(folder_ / mesh_name, mesh);
    set_bytes(folder_ / "s.json", scene);
    scene_ = read_scene((folder_ / "s.json").string(), {}, diagnostics_);
    simulation_ = std::make_unique<Simulation>(scene_->body, "rk4");
    while (simulation_->time() < until - 1e-9) simulation_->step(2e-3);
  }
  double height(const std::string& part) const {
    return simulation_->model().position(simulation_->state(),
                                         scene_->body.index(*scene_->body.find(part)))[2];
  }
  std::string notes() const { return diagnostics_.text(); }

 private:
  NewFolder folder_;
  Diagnostics diagnostics_;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace

TEST_CASE("a ball rests on a box that a glTF node mirrors by a negative scale", "[contact]") {
  const FinishedRun run(
      "box.gltf", mesh_samples::gltf_cube(R"([{"mesh": 0, "scale": [-1, 1, 1], "translation": [0, 0, -1]}])"),
      R"json({"time": {"end": 2, "step": 0.002, "integrator": "rk4"},
        "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.1}, "position": [-0.5, 0.5, 0.6]}],
        "contact": {"obstacles": [{"name": "box", "mesh": "box.gltf"}]}})json",
      1.5);
  CHECK(run.notes().empty());
  CHECK(run.height("ball") == Approx(0.1).margin(1e-4));
}

TEST_CASE("balls fall past a step far from the origin, whose edges are at .10 and .45", "[contact]") {
  const auto ball = [](const char* name, const char* y) {
    return std::string(R"({"name": ")") + name +
           R"(", "shape": "sphere", "parameters": {"r": 0.01}, "position": [500000, )" + y + ", 0.3]}";
  };
  std::string step;
  for (const mesh_samples::Vertex& v : mesh_samples::cube_vertices())
    step += std::string("v ") + (v[0] < 0.5 ? "499999.000 " : "500001.000 ") +
            (v[1] < 0.5 ? "4000000.100 " : "4000000.450 ") + (v[2] < 0.5 ? "-1.000\n" : "0.000\n");
  const std::string cube = mesh_samples::obj_cube();
  const FinishedRun run("step.obj", step + cube.substr(cube.find("f ")),
                        R"json({"time": {"end": 1, "step": 0.002, "integrator": "rk4"}, "parts": [)json" +
                            ball("beside", "4000000.48") + "," + ball("on", "4000000.3") + "," +
                            ball("before", "4000000.05") +
                            R"json(], "contact": {"obstacles": [{"name": "step", "mesh": "step.obj"}]}})json",
                        0.6);
  CHECK(run.notes().empty());
  CHECK(run.height("on") == Approx(0.01).margin(1e-5));
  const double fallen = 0.3 - 0.5 * 9.81 * 0.6 * 0.6;
  CHECK(run.height("beside") == Approx(fallen).epsilon(1e-9));
  CHECK(run.height("before") == Approx(fallen).epsilon(1e-9));
}

TEST_CASE("the flaws of a mesh are notes at its place in the scene") {
  const FinishedRun run("box.obj", mesh_samples::obj_cube() + "v 5 5 5\nl 1 2\n",
                        R"json({"time": {"end": 1, "step": 0.002},
        "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.1}, "position": [0.5, 0.5, 2]}],
        "contact": {"obstacles": [{"name": "box", "mesh": "box.obj"}]}})json",
                        0.01);
  CHECK_THAT(run.notes(),
             test::has_text(
                 "warning: /contact/obstacles/0/mesh: \"box.obj\"; the mesh is cleaned; 1 line or point is "
                 "ignored; 1 vertex is in no triangle and ignored"));
}

}  // namespace mesh_obstacles_test
