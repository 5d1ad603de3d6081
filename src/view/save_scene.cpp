#include <pliant/view/save_scene.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

/// Returns the document of a scene after its overrides, "/pointer=value".
Json document_of(const Scene& scene) {
  Json document = Json::parse(scene.document, nullptr, true, true);
  for (const std::string& assignment : scene.overrides) {
    const std::size_t equals = assignment.find('=');
    const std::string text = assignment.substr(equals + 1);
    Json value = Json::parse(text, nullptr, false);
    document[Json::json_pointer(assignment.substr(0, equals))] = value.is_discarded() ? Json(text) : value;
  }
  return document;
}

Json key_frames_of(const GrowingPath& path) {
  Json points = Json::array();
  const std::vector<double>& t = path.component[0]->times();
  for (std::size_t i = 0; i < t.size(); ++i)
    points.push_back(
        {path.component[0]->values()[i], path.component[1]->values()[i], path.component[2]->values()[i]});
  return {{"t", t}, {"points", std::move(points)}, {"interpolation", "linear"}};
}

Json key_frames_of(const LinearKeys& path) {
  return {{"t", path.times()}, {"y", path.values()}, {"interpolation", "linear"}};
}

Json spring_of(const Drag& drag) {
  const Spring& spring = *drag.spring;
  const MaterialAngles& at = drag.place;
  Json place = {{"u", at.u}, {"v", at.v}, {"w", at.w}};
  if (spring.a.patch > 0) place["patch"] = spring.a.patch;
  Json json = {{"name", spring.name},
               {"from", {{"part", spring.a.part->name()}, {"at", std::move(place)}}},
               {"to", {{"world", key_frames_of(drag.path)}}},
               {"stiffness", spring.stiffness.constant()},
               {"damping", spring.damping.constant()},
               {"on", spring.on}};
  if (std::isfinite(spring.off)) json["off"] = spring.off;
  return json;
}

/// Returns the object of a parameter in the document. If the document has a number or nothing in this place,
/// adds an object with the rest value of the scene.
Json& parameter_of(Json& document, const LiveSimulation& simulation, const RestValue& rest) {
  const auto number = static_cast<std::size_t>(simulation.scene().body.index(*rest.part));
  Json& parameter = document["parts"][number]["parameters"][rest.parameter];
  if (!parameter.is_object()) parameter = Json{{"rest", rest.first}};
  return parameter;
}

/// Writes the rest values that the user has changed into the parts of the document.
void set_rest_values(Json& document, const LiveSimulation& simulation) {
  for (const RestValue& rest : simulation.rest_values()) {
    if (rest.path->times().size() == 1) continue;
    parameter_of(document, simulation, rest)["rest"] = key_frames_of(*rest.path);
  }
}

/// Writes the stiffnesses that the user has changed into the springs of the document.
void set_stiffnesses(Json& document, const LiveSimulation& simulation) {
  for (const SpringStiffness& stiffness : simulation.stiffnesses())
    if (stiffness.path) document["springs"][stiffness.number]["stiffness"] = key_frames_of(*stiffness.path);
}

/// Writes the stiffnesses that the user has changed into the drives of parameters of the document.
void set_drive_stiffnesses(Json& document, const LiveSimulation& simulation) {
  for (const DriveStiffness& stiffness : simulation.drive_stiffnesses()) {
    if (!stiffness.path) continue;
    const auto number = static_cast<std::size_t>(simulation.scene().body.index(*stiffness.part));
    document["parts"][number]["parameters"][stiffness.parameter]["drive"]["stiffness"] =
        key_frames_of(*stiffness.path);
  }
}

/// Returns whether a gravity of a document changes in time.
bool changes(const Json& gravity) {
  return gravity.is_object() ||
         (gravity.is_array() &&
          std::any_of(gravity.begin(), gravity.end(), [](const Json& x) { return !x.is_number(); }));
}

/// Returns component i of a vector function of time in a document.
Json component_of(const Json& vector, std::size_t i) {
  if (vector.is_array()) return vector[i];
  Json frames = vector;
  frames.erase("points");
  for (const Json& point : vector["points"]) frames["y"].push_back(point[i]);
  return frames;
}

/// Writes the gravity that the user has changed into the document.
void set_gravity(Json& document, const LiveSimulation& simulation) {
  if (simulation.gravity() == nullptr) return;
  if (!simulation.changing_gravity()) {
    document["gravity"] = key_frames_of(*simulation.gravity());
    return;
  }
  if (!document.contains("gravity") || !changes(document["gravity"]))
    throw std::invalid_argument(
        "the scene cannot be saved: its gravity changes in time, but the gravity in its file does not; "
        "expected "
        "a scene whose gravity no program has changed");
  Json sums = Json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    Json component = component_of(document["gravity"], i), terms = Json::array();
    if (component.contains("sum"))
      terms = component["sum"];
    else
      terms.push_back(std::move(component));
    terms.push_back(key_frames_of(*simulation.gravity()->component[i]));
    sums.push_back({{"sum", std::move(terms)}});
  }
  document["gravity"] = std::move(sums);
}

/// Adds the servos that change stiffnesses of parameters to the parts of the document.
void set_parameter_stiffnesses(Json& document, const LiveSimulation& simulation) {
  for (const ParameterStiffness& stiffness : simulation.parameter_stiffnesses()) {
    if (stiffness.servo == nullptr || stiffness.added->times().size() == 1) continue;
    const RestValue& rest = simulation.rest_values()[stiffness.rest];
    const bool moves = rest.path->times().size() > 1;
    parameter_of(document, simulation, rest)["drive"] = {
        {"target", moves ? key_frames_of(*rest.path) : Json(rest.first)},
        {"stiffness", key_frames_of(*stiffness.added)}};
  }
}

/// Writes the factors of local stiffness that the user has changed into the parts of the document.
void set_local_stiffnesses(Json& document, const LiveSimulation& simulation) {
  for (const LocalStiffness& stiffness : simulation.local_stiffnesses()) {
    if (stiffness.path->times().size() == 1) continue;
    const auto number = static_cast<std::size_t>(simulation.scene().body.index(*stiffness.part));
    document["parts"][number]["local"]["stiffness_factor"] = key_frames_of(*stiffness.path);
  }
}

/// Makes the paths of mesh files relative to another folder.
void move_meshes(Json& document, const std::filesystem::path& from, const std::filesystem::path& to) {
  if (!document.contains("contact") || !document["contact"].contains("obstacles")) return;
  const std::filesystem::path folder = std::filesystem::absolute(to.empty() ? "." : to).lexically_normal();
  for (Json& obstacle : document["contact"]["obstacles"]) {
    if (!obstacle.contains("mesh")) continue;
    const std::filesystem::path file = std::filesystem::absolute(from / obstacle["mesh"].get<std::string>());
    obstacle["mesh"] = file.lexically_normal().lexically_relative(folder).string();
  }
}

}  // namespace

std::string saved_scene(const LiveSimulation& simulation, const std::filesystem::path& scene_folder,
                        const std::filesystem::path& folder) {
  const Scene& scene = simulation.scene();
  Json document = document_of(scene);
  if (!document.contains("name")) document["name"] = scene.name;
  Json& time = document["time"];
  time["end"] = simulation.time_after(simulation.intervals());
  time["integrator"] = scene.integrator;
  time["stop_rate"] = simulation.rate();
  if (scene.tolerance > 0) {
    time["tolerance"] = scene.tolerance;
    time.erase("step");
  } else {
    time["step"] = scene.step;
  }
  document["output"]["frame_rate"] = simulation.rate();
  set_stiffnesses(document, simulation);
  for (const Drag& drag : simulation.drags()) document["springs"].push_back(spring_of(drag));
  set_gravity(document, simulation);
  set_rest_values(document, simulation);
  set_parameter_stiffnesses(document, simulation);
  set_drive_stiffnesses(document, simulation);
  set_local_stiffnesses(document, simulation);
  move_meshes(document, scene_folder, folder);
  return document.dump(1) + "\n";
}

}  // namespace pliant
