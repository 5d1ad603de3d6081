#include "obstacle_reader.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/scene/json/text_file.h>

#include "color_reader.h"
#include "direction_reader.h"

namespace pliant {

schema::Record obstacle_record(const schema::Type& orientation, const schema::Type& color) {
  using namespace schema;
  Record obstacle{
      "obstacle",
      "An immobile triangle mesh or plate.",
      {required("name", name(), "Name that no part, plane or other obstacle has.", "\"bowl\""),
       optional("mesh", text(1),
                "Surface mesh: a file .obj, .ply, .stl, .gltf, .glb, .dae, .fbx, .3ds or .off, relative to "
                "the folder of the scene. "
                "Triangles are counter-clockwise seen from the free side. A body that comes from behind "
                "passes through an open mesh."),
       optional("half_extents", array(number(above(0), "m"), 2, 2),
                "Instead of a mesh: half extents along x and y of a rectangle normal to z, solid from both "
                "sides."),
       optional("scale", number(above(0), "1"), "Metres per unit of the file.", "1"),
       optional("position", vector3("m"), "Position of the origin of the mesh or plate.", "[0, 0, 0]"),
       optional("orientation", orientation, "Orientation of the axes of the mesh or plate.",
                "{\"quaternion\": [1, 0, 0, 0]}"),
       optional("on", number(at_least(0), "s"), "Time at which the obstacle appears.", "0"),
       optional("off", number(above(0), "s"), "Time at which the obstacle disappears; when absent, never."),
       optional("color", color, "Colour in pictures.", "\"#9a9488\""),
       optional("visible", boolean(), "Whether pictures and meshes show it.", "true")}};
  obstacle.exclusive = {{{"mesh", "half_extents"}, true}};
  return obstacle;
}

namespace {

/// Returns the mesh of an obstacle, or std::nullopt after a fault, which is reported.
std::optional<MeshFile> read_mesh(const Reader& r, const MeshFolder& folder, SceneFaults& faults) {
  const std::filesystem::path file =
      folder.path / (folder.of_a_run ? recorded_mesh_name(r.text("name")) : r.text("mesh"));
  try {
    MeshFile mesh = read_mesh_file(file);
    std::string notes;
    for (const std::string& note : mesh.notes) notes += "; " + note;
    if (!notes.empty()) faults.warn(r.at("mesh"), "the mesh is cleaned" + notes);
    return mesh;
  } catch (const FileError& fault) {
    faults.value(r.at("mesh"), fault.what());
  } catch (const std::invalid_argument& fault) {
    faults.value(r.at("mesh"), fault.what());
  }
  return std::nullopt;
}

}  // namespace

void read_obstacle(const Reader& r, const std::vector<std::string>& taken, const MeshFolder& folder,
                   SceneFaults& faults, Scene& scene) {
  const Eigen::Quaterniond orientation = read_orientation(r.object("orientation"), faults);
  if (r.given("off") && !(r.number("on") < r.number("off")))
    faults.value(r.at("off"), "expected a time after \"on\", which is " + brief(r.number("on")) + " s");
  if (!r.complete() || !(r.given("mesh") || r.given("half_extents"))) return;
  const std::string& name = r.text("name");
  if (std::find(taken.begin(), taken.end(), name) != taken.end())
    return faults.value(r.at("name"),
                        "another part, plane or obstacle has this name; expected a different name");
  ObstacleLook look;
  look.color = read_color(r.at("color"));
  look.visible = r.boolean("visible");
  const Vec3<double> position = r.vector3("position");
  ContactObstacle* made = nullptr;
  if (r.given("half_extents")) {
    const std::vector<double> half = r.numbers("half_extents");
    made = &scene.body.plate(name, position, orientation, half[0], half[1]);
  } else {
    std::optional<MeshFile> mesh = read_mesh(r, folder, faults);
    if (!mesh) return;
    try {
      const ObstacleMesh placed(
          (r.number("scale") * orientation.toRotationMatrix() * mesh->vertices).colwise() + position,
          mesh->triangles);
      made = &scene.body.obstacle(name, placed.vertices(), placed.triangles());
    } catch (const std::invalid_argument& fault) {
      return faults.value(r.at("mesh"), fault.what());
    }
    look.mesh = std::move(*mesh);
  }
  made->on = r.number("on");
  if (r.given("off")) made->off = r.number("off");
  scene.obstacles.push_back(std::move(look));
}

}  // namespace pliant
