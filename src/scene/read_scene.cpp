#include <pliant/part/quadrature/body_points.h>
#include <pliant/scene/read_scene.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <pliant/scene/faulty_values.h>
#include <pliant/scene/json/json_document.h>
#include <pliant/scene/reader/reader.h>
#include <pliant/scene/schema/scene_schema.h>
#include <pliant/scene/validate.h>
#include <pliant/simulate/choose_integrator.h>

#include "scene/reader/color_reader.h"
#include "scene/reader/coloring_reader.h"
#include "scene/reader/contact_reader.h"
#include "scene/reader/direction_reader.h"
#include "scene/reader/drive_reader.h"
#include "scene/reader/joint_reader.h"
#include "scene/reader/obstacle_reader.h"
#include "scene/reader/part_reader.h"
#include "scene/reader/point_reader.h"
#include "scene/reader/scene_warnings.h"
#include "scene/reader/state_reader.h"
#include "scene/reader/time_reader.h"
#include "scene_faults.h"

namespace pliant {

namespace {

/// Returns the default colour of part i: tone i modulo 8 of eight distinguishable tones.
Color palette(std::size_t i) {
  static constexpr std::array<Color, 8> tones{{{0.85, 0.47, 0.20},
                                               {0.24, 0.49, 0.70},
                                               {0.93, 0.75, 0.26},
                                               {0.41, 0.62, 0.38},
                                               {0.72, 0.33, 0.36},
                                               {0.52, 0.43, 0.66},
                                               {0.33, 0.64, 0.63},
                                               {0.80, 0.62, 0.50}}};
  return tones[i % tones.size()];
}

/// Makes a scene from a validated document. Faults found while reading are added to the diagnostics. Faulty
/// values are skipped.
class SceneReader {
 public:
  SceneReader(const JsonDocument& document, MeshFolder folder, Diagnostics& diagnostics)
      : document_(document),
        folder_(std::move(folder)),
        faulty_(faulty_values(document, diagnostics)),
        faults_(document, diagnostics),
        root_(document.root(), scene_record(), &faulty_) {}

  std::unique_ptr<Scene> read(const JointSolver& solver) {
    auto scene = std::make_unique<Scene>();
    scene_ = scene.get();
    scene_->body.joint_solver = solver;
    scene_->name =
        root_.given("name") ? root_.text("name") : std::filesystem::path(document_.name()).stem().string();
    scene_->description = root_.text("description");
    read_time();
    read_gravity();
    read_view();
    for (const auto& [name, material] : root_.entries("materials")) materials_.emplace(name, material);
    for (const Reader& r : root_.objects("parts")) read_part(r);
    const PointReader points(parts_, scene_->end, faults_);
    scene_->body.stabilization = read_stabilization(root_.object("stabilization"), faults_);
    for (const Reader& r : named("joints"))
      for (const Joint* joint : read_joint(r, points, faults_, scene_->body))
        if (!has_ring(r)) joints_.emplace_back(r, joint);
    if (root_.given("contact"))
      read_contact(root_.object("contact"), parts_, times(), folder_, faults_, *scene_);
    for (const Reader& r : named("springs")) read_spring(r, points);
    for (const Reader& r : named("tracks")) read_track(r, points);
    read_actuation(points);
    read_coloring();
    if (faults_.errors() == 0) add_warnings(*scene_, root_, faults_);
    return scene;
  }

 private:
  void read_time() {
    const Reader time = root_.object("time"), output = root_.object("output");
    scene_->end = time.number("end");
    scene_->step = time.number("step");
    if (time.given("integrator"))
      scene_->integrator = time.text("integrator");
    else
      scene_->integrator = time.given("step") && !time.given("tolerance") ? kFixedStepIntegrator : kAutomatic;
    if (time.given("tolerance")) read_tolerance(time);
    if (scene_->integrator == kAutomatic && scene_->tolerance == 0) scene_->tolerance = kStandardTolerance;
    if (scene_->tolerance > 0 && time.given("step"))
      faults_.warn(time.at("step"), "it has no effect, because the tolerance controls the step length");
    scene_->body.joint_solver.choice = joint_solver(time.text("solver"));
    scene_->body.stop_rate = time.number("stop_rate");
    scene_->frame_rate = output.number("frame_rate");
    constexpr double kMax = 1e12;
    if (scene_->end / scene_->step > kMax)
      faults_.value(time.at(time.given("step") ? "step" : "end"),
                    "this gives " + brief(scene_->end / scene_->step) + " steps until the end at " +
                        brief(scene_->end) + " s; expected at most 1e12");
    if (scene_->end * scene_->frame_rate > kMax)
      faults_.value(output.given("frame_rate") ? output.at("frame_rate") : time.at("end"),
                    "this gives " + brief(scene_->end * scene_->frame_rate) + " frames until the end at " +
                        brief(scene_->end) + " s; expected at most 1e12");
    if (output.given("every_part")) scene_->every_part = output.boolean("every_part");
    scene_->contacts = output.boolean("contacts");
    if (scene_->contacts && !root_.given("contact"))
      faults_.warn(output.at("contacts"), "it has no effect, because the scene has no \"contact\"");
    const std::vector<double> size = output.numbers("size");
    scene_->width = static_cast<int>(size[0]);
    scene_->height = static_cast<int>(size[1]);
  }

  void read_tolerance(const Reader& time) {
    scene_->tolerance = time.number("tolerance");
    if (scene_->integrator == kAutomatic) return;
    const std::vector<std::string> controlled = controlled_integrators();
    if (std::find(controlled.begin(), controlled.end(), scene_->integrator) != controlled.end()) return;
    std::string names = std::string("\"") + kAutomatic + "\"";
    for (const std::string& name : controlled) names += ", \"" + name + "\"";
    faults_.value(time.at("integrator"),
                  "it has no error estimate, which \"tolerance\" needs; expected one of " + names);
  }

  void read_gravity() {
    if (!root_.given("gravity")) return;
    const std::optional<TimeVector> gravity = times().vector(root_, "gravity", Needs::value_and_rate);
    if (!gravity) return;
    if (gravity->is_constant())
      scene_->body.gravity = gravity->value(0);
    else
      scene_->body.changing_gravity = *gravity;
  }

  void read_view() {
    const Reader camera = root_.object("camera"), light = root_.object("light"),
                 ground = root_.object("ground");
    if (camera.given("eye")) scene_->camera.eye = camera.vector3("eye");
    if (camera.given("target")) scene_->camera.target = camera.vector3("target");
    if (camera.given("eye") && camera.given("target")) {
      const Vec3<double> look = *scene_->camera.target - *scene_->camera.eye;
      if (look.isZero(0))
        faults_.value(camera.at("target"), "the eye is at this point too; expected another point");
    }
    scene_->camera.field_of_view = camera.number("field_of_view");
    if (light.given("direction")) scene_->light.direction = read_direction(light.at("direction"), faults_);
    scene_->light.shadows = light.boolean("shadows");
    scene_->ground.visible = ground.boolean("visible");
    if (ground.given("height")) scene_->ground.height = ground.number("height");
  }

  void read_part(const Reader& r) {
    if (r.given("name")) {
      const auto [entry, is_new] =
          parts_.try_emplace(r.text("name"), NamedPart{&r.at("name"), nullptr, false});
      if (!is_new) faults_.twice(*entry->second.name, r.at("name"));
    }
    if (r.given("material")) check_material(r.at("material"));
    PartReader reader(r, materials_, scene_->body, scene_->end, faults_);
    std::unique_ptr<Part> made = reader.read();
    if (!made || !r.given("name") || scene_->body.find(r.text("name")) != nullptr) return;
    parts_[r.text("name")] = {&r.at("name"), &scene_->body.add(std::move(made)), reader.prepared()};
    Appearance look;
    look.color = r.given("color") ? read_color(r.at("color")) : palette(scene_->appearance.size());
    look.resolution = static_cast<int>(r.integer("resolution"));
    look.visible = r.boolean("visible");
    if (look.visible) check_mesh(r, *parts_[r.text("name")].part, look.resolution);
    scene_->appearance.push_back(look);
  }

  /// Warns if the surface mesh of a part has fewer than 8 edges per turn of its twist.
  void check_mesh(const Reader& r, const Part& part, int resolution) {
    double turns = 0;  // of one end relative to the other end; twist.angle is the angle from middle to end
    for (int i = 0; i < part.parameters().size(); ++i) {
      const Parameter& p = part.parameters()[i];
      if (p.name.rfind("twist", 0) == 0)  // "twist.angle", "twist2.angle"
        turns += std::max(std::abs(p.rest_value()), p.dynamic ? std::abs(p.initial) : 0) / kPi;
    }
    constexpr double edges_per_turn = 8;
    const double needed =
        std::ceil(turns * edges_per_turn / 2);  // there are 2 * resolution edges between the two ends
    if (resolution < needed)
      faults_.warn(
          r.given("resolution") ? r.at("resolution") : r.at("name"),
          "its mesh has fewer than 8 edges per turn of the twist; " +
              (needed <= 128 ? "expected a resolution of at least " + std::to_string(static_cast<int>(needed))
                             : std::string("no resolution up to 128 is sufficient")));
  }

  void check_material(const JsonValue& name) {
    std::vector<std::string> names;
    const JsonValue* materials = document_.root().find("materials");
    if (materials != nullptr && !materials->is_object()) return;  // the validation has reported this fault
    if (materials != nullptr)
      for (const JsonValue::Member& member : materials->members())
        if (!schema::is_ignored_key(member.key)) names.push_back(member.key);
    if (std::find(names.begin(), names.end(), name.string()) == names.end())
      faults_.unknown(name, "material", names);
  }

  /// Returns the objects of a list. Reports names that are given twice, also names of the joints of a ring.
  std::vector<Reader> named(const std::string& list) {
    std::vector<Reader> all = root_.objects(list);
    std::map<std::string, const JsonValue*> names;
    for (const Reader& r : all) {
      if (!r.given("name")) continue;
      std::vector<std::string> own = ring_names(r);
      own.push_back(r.text("name"));
      for (const std::string& name : own) {
        const auto [first, is_new] = names.try_emplace(name, &r.at("name"));
        if (is_new) continue;
        faults_.twice(*first->second, r.at("name"));
        break;
      }
    }
    return all;
  }
  void read_spring(const Reader& r, const PointReader& points) {
    const std::optional<Point> from = points.end(r, "from"), to = points.end(r, "to");
    if (!from || !to || !r.complete()) return;
    if (from->part == nullptr && to->part == nullptr)
      return faults_.place(r.json(), "both ends are points of the world; expected at least one on a part");
    if (from->part == to->part && same_point(from->material, to->material))
      return faults_.place(r.at("to"), "this is the same point as \"from\"; expected another");
    const JsonValue& rest_length = r.at("rest_length");
    const double length = rest_length.is_number() ? rest_length.number() : 0;
    if (length > 0 && (position_at_start(*from) - position_at_start(*to)).norm() <= 1e-9 * length)
      return faults_.value(
          r.at("rest_length"),
          "both ends are at the same place at time 0, so a spring with a rest length has no direction; "
          "expected 0, or ends at different places");
    if (r.given("off") && !(r.number("on") < r.number("off")))
      return faults_.value(r.at("off"),
                           "expected a time after \"on\", which is " + brief(r.number("on")) + " s");
    Spring& spring = scene_->body.spring(name_of(r, "spring", scene_->body.springs().size()), *from, *to, 0);
    if (r.given("on")) spring.on = r.number("on");
    if (r.given("off")) spring.off = r.number("off");
    springs_.emplace_back(r, &spring);
  }
  /// Reads all values that may be functions of the state. The parts, joints, springs and tracks that the
  /// formulas name must already be in the scene.
  void read_actuation(const PointReader& points) {
    for (const auto& [r, joint] : joints_) read_joint_limits(r, *joint, faults_, scene_->body);
    const StateReader states(*scene_, faults_);
    for (const Reader& r : named("sensors"))
      if (r.complete())
        if (const auto value = states.function(r.at("value"))) scene_->body.sensor(r.text("name"), *value);
    for (const auto& [r, spring] : springs_) read_spring_law(r, states, *spring);
    for (const Reader& r : named("forces")) read_force(r, points, states);
    for (const Reader& r : named("torques")) read_torque(r, points, states);
    using Domain = DistributedForce::Domain;
    const StateReader on_surface(*scene_, faults_, quantities_at_points(Domain::surface));
    for (const Reader& r : named("surface_forces")) read_surface_force(r, points, on_surface);
    const StateReader in_body(*scene_, faults_, quantities_at_points(Domain::body));
    for (const Reader& r : named("body_forces")) read_body_force(r, points, in_body);
    for (const auto& [r, joint] : joints_)
      if (r.json().find("drive") != nullptr && !r.faulty("drive"))
        read_joint_drive(r.object("drive"), *joint, states, scene_->body);
    for (const Reader& r : root_.objects("parts")) read_parameter_drives(r, states);
  }
  static void read_spring_law(const Reader& r, const StateReader& states, Spring& spring) {
    for (const auto& [key, function] :
         {std::pair<const char*, StateFunction*>("stiffness", &spring.stiffness),
          {"damping", &spring.damping},
          {"rest_length", &spring.rest_length}})
      if (const auto read = states.function(r.at(key))) *function = *read;
  }
  void read_parameter_drives(const Reader& r, const StateReader& states) {
    const auto named = r.given("name") ? parts_.find(r.text("name")) : parts_.end();
    if (named == parts_.end() || named->second.part == nullptr) return;
    const Part& part = *named->second.part;
    for (const auto& [name, parameter] : r.entries("parameters")) {
      const JsonValue* drive = parameter.json().is_object() ? parameter.json().find("drive") : nullptr;
      if (drive == nullptr || parameter.faulty("drive") || part.parameters().dynamic_number(name) < 0)
        continue;
      Drive& servo = scene_->body.drive(part.name() + "." + name, part, name);
      const bool elastic = r.given("stiffness_matrix") || r.given("elasticity") || r.given("material");
      if (read_drive(parameter.object("drive"), states, servo) && (parameter.given("stiffness") || !elastic))
        check_sum_of_stiffnesses(parameter, servo, faults_);
    }
  }
  TimeReader times() { return {scene_->end, faults_}; }
  static Frame frame(const Reader& r) { return r.text("frame") == "body" ? Frame::body : Frame::world; }
  void read_force(const Reader& r, const PointReader& points, const StateReader& states) {
    const std::optional<Point> at = points.on_part(r);
    const std::optional<StateVector> force = states.vector(r, "force");
    if (at && force)
      scene_->body.force(name_of(r, "force", scene_->body.forces().size()), *at, *force, frame(r));
  }
  void read_torque(const Reader& r, const PointReader& points, const StateReader& states) {
    const Part *part = points.part(r), *against = points.part(r, "against");
    const std::optional<StateVector> torque = states.vector(r, "torque");
    if (part == nullptr) return;
    if (part == against)
      return faults_.value(r.at("against"), "this is the same part as \"part\"; expected another");
    if (torque)
      scene_->body.torque(name_of(r, "torque", scene_->body.torques().size()), *part, *torque, frame(r))
          .against = against;
  }
  void read_surface_force(const Reader& r, const PointReader& points, const StateReader& states) {
    const Part* part = points.part(r);
    if (r.json().find("traction") == nullptr && r.json().find("pressure") == nullptr)
      return faults_.value(r.json(), "expected a \"traction\" or a \"pressure\"");
    std::optional<StateVector> traction = StateVector();
    if (r.given("traction")) traction = states.vector(r, "traction");
    std::optional<StateFunction> pressure = StateFunction();
    if (r.given("pressure")) pressure = states.function(r.at("pressure"));
    if (part == nullptr || !traction || !pressure) return;
    const std::string name = name_of(r, "surface_force", scene_->body.distributed_forces().size());
    finish(r, *part, scene_->body.surface_force(name, *part, *traction, *pressure));
  }
  void read_body_force(const Reader& r, const PointReader& points, const StateReader& states) {
    const Part* part = points.part(r);
    const std::optional<StateVector> acceleration = states.vector(r, "acceleration");
    if (part == nullptr || !acceleration) return;
    if (part->prepared() && !has_known_masses(*part))
      return faults_.place(
          r.at("part"),
          "the \"inertia\" of this part does not say where its mass is; expected a part with a "
          "density or a mass");
    const std::string name = name_of(r, "body_force", scene_->body.distributed_forces().size());
    finish(r, *part, scene_->body.body_force(name, *part, *acceleration));
  }
  /// Reads the resolution of a distributed force. Warns of keys without effect.
  void finish(const Reader& r, const Part& part, DistributedForce& force) {
    force.resolution = static_cast<int>(r.integer("resolution"));
    if (part.fixed())
      faults_.warn(r.at("part"), "the force has no effect, because the part has no freedom to move");
    if (r.json().find("resolution") != nullptr && part.prepared() && part.local() != nullptr &&
        part.local()->mesh().mass.size() > 0)
      faults_.warn(r.at("resolution"), "it has no effect, because the part has a mesh of its own");
  }
  void read_track(const Reader& r, const PointReader& points) {
    const std::optional<Point> at = points.on_part(r);
    if (!at) return;
    Track track;
    track.point = *at;
    track.name = name_of(r, "track", scene_->tracks.size());
    if (r.given("color")) track.color = read_color(r.at("color"));
    scene_->tracks.push_back(track);
  }

  void read_coloring() {
    if (!root_.given("coloring")) return;
    const Reader coloring = root_.object("coloring");
    if (!coloring.complete()) return;
    scene_->coloring = pliant::read_coloring(coloring, parts_, faults_);
    const auto& parts = scene_->body.parts();
    if (faults_.errors() == 0 && std::none_of(parts.begin(), parts.end(), [&](const auto& part) {
          return colors(*scene_->coloring, *part);
        }))
      faults_.warn(coloring.at("by"), "it has no effect, because no part deforms");
  }

  const JsonDocument& document_;
  const MeshFolder folder_;
  const FaultyValues faulty_;
  SceneFaults faults_;
  const Reader root_;
  std::map<std::string, Reader> materials_;
  std::map<std::string, NamedPart> parts_;
  std::vector<std::pair<Reader, const Joint*>> joints_;  ///< joints that may have limits and a drive
  std::vector<std::pair<Reader, Spring*>> springs_;
  Scene* scene_ = nullptr;
};

/// Returns the 64-bit FNV-1a hash of a text.
std::uint64_t fnv1a_hash(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3u;
  }
  return hash;
}

/// Returns the scene of a document after the overrides. The hash of the scene covers the text, the overrides,
/// and the vertices and triangles of the mesh files. Throws SceneError if the scene has errors.
std::unique_ptr<Scene> make_scene(JsonDocument document, const std::vector<std::string>& overrides,
                                  MeshFiles files, const JointSolver& solver, Diagnostics& diagnostics) {
  const MeshFolder folder{std::filesystem::path(document.name()).parent_path(), files == MeshFiles::of_a_run};
  for (const std::string& assignment : overrides) document.set(assignment, diagnostics);
  validate(document, scene_record(), diagnostics);
  if (!document.root().is_object() || diagnostics.full()) diagnostics.throw_if_errors();
  std::unique_ptr<Scene> scene = SceneReader(document, folder, diagnostics).read(solver);
  diagnostics.throw_if_errors();
  std::string resolved = document.text();
  for (const std::string& assignment : overrides) resolved += "\n" + assignment;
  for (const ObstacleLook& obstacle : scene->obstacles) {
    const MeshFile& mesh = obstacle.mesh;
    resolved.append(reinterpret_cast<const char*>(mesh.vertices.data()),
                    static_cast<std::size_t>(mesh.vertices.size()) * sizeof(double));
    resolved.append(reinterpret_cast<const char*>(mesh.triangles.data()),
                    static_cast<std::size_t>(mesh.triangles.size()) * sizeof(int));
  }
  scene->hash = fnv1a_hash(resolved);
  scene->document = document.text();
  scene->overrides = overrides;
  return scene;
}

}  // namespace

std::unique_ptr<Scene> read_scene(const std::string& file, const std::vector<std::string>& overrides,
                                  Diagnostics& diagnostics, const JointSolver& solver, MeshFiles files) {
  return make_scene(JsonDocument::read(file, diagnostics), overrides, files, solver, diagnostics);
}

std::unique_ptr<Scene> parse_scene(const std::string& name, std::string text,
                                   const std::vector<std::string>& overrides, Diagnostics& diagnostics) {
  return make_scene(JsonDocument::parse(name, std::move(text), diagnostics), overrides, MeshFiles::as_named,
                    {}, diagnostics);
}

}  // namespace pliant
