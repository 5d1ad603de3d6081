#include <pliant/scene/read_scene.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>

#include <pliant/math/nearest_name.h>
#include <pliant/part/registry.h>
#include <pliant/scene/json_document.h>
#include <pliant/scene/point_value.h>
#include <pliant/scene/reader.h>
#include <pliant/scene/scene_schema.h>
#include <pliant/scene/time_value.h>
#include <pliant/scene/validate.h>

namespace pliant {

namespace {

Color color(const JsonValue& v) {
  if (v.is_array()) return {v.array()[0].number(), v.array()[1].number(), v.array()[2].number()};
  Color c;
  for (std::size_t i = 0; i < 3; ++i) c[i] = std::stoi(v.string().substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
  return c;
}

/// Colours of parts that name none; quiet tones that stay apart.
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

class SceneReader {
 public:
  SceneReader(const JsonDocument& document, Diagnostics& faults) : document_(document), faults_(faults) {}

  std::unique_ptr<Scene> read() {
    auto scene = std::make_unique<Scene>();
    scene_ = scene.get();
    const Reader root(document_.root(), scene_record());
    scene_->name =
        root.given("name") ? root.text("name") : std::filesystem::path(document_.name()).stem().string();
    scene_->description = root.text("description");
    scene_->body.gravity = root.vector3("gravity");
    read_settings(root);
    for (const Reader& r : root.objects("parts")) read_part(r);
    for (const Reader& r : root.objects("springs")) read_spring(r);
    for (const Reader& r : root.objects("forces")) read_force(r);
    for (const Reader& r : root.objects("torques")) read_torque(r);
    for (const Reader& r : root.objects("tracks")) read_track(r);
    return scene;
  }

 private:
  void fault(const JsonValue& at, const std::string& message) { faults_.add(document_.fault(at, message)); }
  void warn(const JsonValue& at, const std::string& message) {
    faults_.add(document_.fault(at, message, Severity::kWarning));
  }
  /// What the engine refuses is a fault at the value that asked for it.
  template <class F>
  bool attempt(const JsonValue& at, F&& f) {
    try {
      f();
      return true;
    } catch (const std::invalid_argument& e) {
      fault(at, e.what());
    }
    return false;
  }

  void read_settings(const Reader& root) {
    const Reader time = root.object("time"), output = root.object("output"), camera = root.object("camera"),
                 light = root.object("light"), ground = root.object("ground");
    scene_->end = time.number("end");
    scene_->step = time.number("step");
    scene_->integrator = time.text("integrator");
    if (scene_->end / scene_->step > 1e12)
      fault(time.json(), "end / step is more than 1e12 steps; expected a larger step or an earlier end");
    scene_->frame_rate = output.number("frame_rate");
    const std::vector<double> size = output.numbers("size");
    scene_->width = static_cast<int>(size[0]);
    scene_->height = static_cast<int>(size[1]);
    if (camera.given("eye")) scene_->camera.eye = camera.vector3("eye");
    if (camera.given("target")) scene_->camera.target = camera.vector3("target");
    if (camera.given("eye") && camera.given("target") && *scene_->camera.eye == *scene_->camera.target)
      fault(camera.json(), "eye and target are the same point; a camera looks from one to the other");
    scene_->camera.field_of_view = camera.number("field_of_view");
    if (light.given("direction")) scene_->light.direction = direction_of(light.at("direction"));
    scene_->light.shadows = light.boolean("shadows");
    scene_->ground.visible = ground.boolean("visible");
    if (ground.given("height")) scene_->ground.height = ground.number("height");
  }

  Vec3<double> direction_of(const JsonValue& v) {
    const Vec3<double> d = read_vector3(v);
    if (!(d.norm() > 0)) {
      fault(v, "a direction of length 0");
      return {0, 0, 1};
    }
    return d;
  }

  void read_part(const Reader& r) {
    const std::string name = r.text("name");
    if (scene_->body.find(name) != nullptr) {
      fault(r.at("name"), "there is already a part called \"" + name + "\"; names must be unique");
      return;
    }
    std::vector<std::string> deformations;
    for (const JsonValue& d : r.at("deformations").array()) deformations.push_back(d.string());

    const JsonValue* material = r.given("material") ? material_of(r.at("material")) : nullptr;
    auto property = [&](const char* key) {
      const JsonValue* shared = material != nullptr && !r.given(key) ? material->find(key) : nullptr;
      return shared != nullptr ? shared->number() : r.number(key);
    };

    std::unique_ptr<Part> made;
    if (!attempt(r.json(),
                 [&] { made = make_part(name, r.text("shape"), deformations, property("density")); }))
      return;
    Part& part = scene_->body.add(std::move(made));
    Appearance look;
    look.color = r.given("color") ? color(r.at("color")) : palette(scene_->appearance.size());
    look.resolution = static_cast<int>(r.integer("resolution"));
    look.visible = r.boolean("visible");
    scene_->appearance.push_back(look);

    if (r.boolean("shell")) part.make_shell();
    part.damping(property("alpha"), property("beta"), property("drag"));
    if (r.given("mass")) part.mass(r.number("mass"));
    bool good = read_parameters(part, r.at("parameters"));
    if (r.given("stiffness_matrix")) good = read_stiffness(part, r.object("stiffness_matrix")) && good;
    if (r.given("inertia")) good = read_inertia(part, r.object("inertia")) && good;
    part.place(r.vector3("position"), read_orientation(r.object("orientation")));
    part.move(r.vector3("velocity"), r.vector3("angular_velocity"));
    if (r.boolean("fixed")) part.fix();
    // Folding, limits and the like show when the constants are taken.
    if (good) attempt(r.json(), [&] { part.prepare(); });
  }

  /// The entry of materials that a part names, or nullptr with a fault.
  const JsonValue* material_of(const JsonValue& name) {
    const JsonValue* materials = document_.root().find("materials");
    const JsonValue* found = materials != nullptr ? materials->find(name.string()) : nullptr;
    if (found != nullptr) return found;
    std::vector<std::string> names;
    if (materials != nullptr)
      for (const auto& member : materials->members()) names.push_back(member.key);
    fault(name, "no material is called \"" + name.string() + "\"" + hint(name.string(), names));
    return nullptr;
  }

  static std::string hint(const std::string& word, const std::vector<std::string>& names) {
    const std::string near = did_you_mean(word, names);
    if (!near.empty()) return near;
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
    return all.empty() ? "; there is none" : "; there are: " + all;
  }

  bool read_parameters(Part& part, const JsonValue& parameters) {
    const Parameters& known = part.parameters();
    std::vector<std::string> names;
    for (int i = 0; i < known.size(); ++i) names.push_back(known[i].name);
    bool good = true;
    for (const auto& member : parameters.members()) {
      if (schema::is_ignored_key(member.key)) continue;
      const std::string& name = member.key;
      const JsonValue& v = member.value;
      if (known.find(name) < 0) {
        faults_.add(document_.fault_at_key(parameters, name,
                                           "part \"" + part.name() + "\" has no parameter \"" + name + "\"" +
                                               hint(name, names) + "; it has: " + known.names()));
        good = false;
        continue;
      }
      if (v.is_number()) {  // frozen at this value
        good = attempt(v, [&] { part.rest({{name, v.number()}}); }) && good;
        continue;
      }
      if (const JsonValue* rest = v.find("rest"))
        good = attempt(*rest,
                       [&] {
                         if (rest->is_number())
                           part.rest({{name, rest->number()}});
                         else
                           part.rest(name, read_time_function(*rest));
                       }) &&
               good;
      if (const JsonValue* k = v.find("stiffness")) part.stiffness({{name, k->number()}});
      if (const JsonValue* q = v.find("initial")) part.initial({{name, q->number()}});
      if (const JsonValue* rate = v.find("initial_rate")) part.initial_rate({{name, rate->number()}});
      if (const JsonValue* dynamic = v.find("dynamic")) {
        if (dynamic->boolean())
          part.make_dynamic({name});
        else if (known[known.find(name)].dynamic)
          fault(*dynamic, name + " is said to be frozen but has an initial value, a rate or a stiffness");
      }
      if (v.find("min") != nullptr || v.find("max") != nullptr) {
        const Parameter& p = known[known.find(name)];
        const double scale = p.spec->relative ? p.rest_value() : 1.0;
        const JsonValue *min = v.find("min"), *max = v.find("max");
        const Range range{min != nullptr ? min->number() : p.spec->dynamic.min * scale,
                          max != nullptr ? max->number() : p.spec->dynamic.max * scale};
        good = attempt(v, [&] { part.limits(name, range); }) && good;
        if (!p.dynamic) warn(v, "limits of " + name + " have no effect: it is frozen");
      }
    }
    return good;
  }

  bool read_stiffness(Part& part, const Reader& r) {
    std::vector<std::string> names;
    for (const JsonValue& n : r.at("parameters").array()) names.push_back(n.string());
    const auto& rows = r.at("K").array();
    const auto n = static_cast<Eigen::Index>(names.size());
    MatX<double> K(n, n);
    for (const JsonValue& row : rows)
      if (static_cast<Eigen::Index>(rows.size()) != n || static_cast<Eigen::Index>(row.array().size()) != n) {
        fault(r.at("K"),
              "K must have a row and a column for each of the " + std::to_string(n) + " parameters");
        return false;
      }
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        K(i, j) = rows[static_cast<std::size_t>(i)].array()[static_cast<std::size_t>(j)].number();
    return attempt(r.json(), [&] { part.stiffness(names, K); });
  }

  bool read_inertia(Part& part, const Reader& r) {
    Mat3<double> moments;
    for (int i = 0; i < 3; ++i)
      moments.row(i) = read_vector3(r.at("moments").array()[static_cast<std::size_t>(i)]);
    return attempt(r.json(), [&] { part.inertia(r.number("mass"), moments, r.vector3("centre")); });
  }

  Eigen::Quaterniond read_orientation(const Reader& r) {
    if (r.name() == "by_axis")
      return Eigen::Quaterniond(
          Eigen::AngleAxisd(r.number("angle"), direction_of(r.at("axis")).normalized()));
    const std::vector<double> q = r.numbers("quaternion");
    const Eigen::Quaterniond R(q[0], q[1], q[2], q[3]);
    if (!(R.norm() > 0)) {
      fault(r.at("quaternion"), "a quaternion of length 0 is no rotation");
      return Eigen::Quaterniond::Identity();
    }
    if (std::abs(R.norm() - 1) > 1e-3)
      warn(r.at("quaternion"), "its length is not 1; it is taken as the rotation of the same direction");
    return R.normalized();
  }

  /// The part that a key names, or nullptr with a fault.
  Part* part_of(const JsonValue& name) {
    Part* part = scene_->body.find(name.string());
    if (part != nullptr) return part;
    std::vector<std::string> names;
    for (const auto& p : scene_->body.parts()) names.push_back(p->name());
    fault(name, "no part is called \"" + name.string() + "\"" + hint(name.string(), names));
    return nullptr;
  }

  /// Resolved at the rest shape.
  Material<double> material_point(const Part& part, const MaterialPointValue& value) const {
    using Form = MaterialPointValue::Form;
    if (value.form == Form::kCoordinates) return material_at(value.x[0], value.x[1], value.x[2]);
    if (value.form == Form::kDirection) {
      if (part.shape().mesh() == MeshPattern::torus)
        throw std::invalid_argument(
            "a torus has no single point in a direction; give {\"u\", \"v\", \"w\"} or {\"near\"}");
      Material<double> m = part.label(value.x.normalized() * part.size(), part.parameters().rest());
      m.w = value.w;
      return m;
    }
    Material<double> m = part.label(value.x, part.parameters().rest());
    m.w = std::min(m.w, 1.0);
    return m;
  }

  /// Where a point is given by "part" and "at".
  bool point_on_part(const Reader& r, Point& point) {
    const Part* part = part_of(r.at("part"));
    if (part == nullptr) return false;
    point.part = part;
    return attempt(r.at("at"),
                   [&] { point.material = material_point(*part, read_material_point(r.at("at"))); });
  }
  bool end_point(const Reader& r, Point& point) {
    if (!r.given("world")) return point_on_part(r, point);
    point.world = r.time_vector("world");
    return true;
  }
  static std::string name_of(const Reader& r, const char* kind, std::size_t number) {
    return r.given("name") ? r.text("name") : kind + std::to_string(number + 1);
  }

  void read_spring(const Reader& r) {
    Point from, to;
    const bool a = end_point(r.object("from"), from), b = end_point(r.object("to"), to);
    if (!a || !b) return;
    if (from.part == nullptr && to.part == nullptr) {
      fault(r.json(), "this spring ties the world to itself; one end must be on a part");
      return;
    }
    scene_->body.spring(name_of(r, "spring", scene_->body.springs().size()), from, to, r.number("stiffness"),
                        r.number("damping"), r.number("rest_length"));
  }
  static Frame frame(const Reader& r) { return r.text("frame") == "body" ? Frame::body : Frame::world; }
  void read_force(const Reader& r) {
    Point at;
    if (point_on_part(r, at))
      scene_->body.force(name_of(r, "force", scene_->body.forces().size()), at, r.time_vector("force"),
                         frame(r));
  }
  void read_torque(const Reader& r) {
    if (const Part* part = part_of(r.at("part")))
      scene_->body.torque(name_of(r, "torque", scene_->body.torques().size()), *part, r.time_vector("torque"),
                          frame(r));
  }
  void read_track(const Reader& r) {
    Track track;
    if (!point_on_part(r, track.point)) return;
    track.name = name_of(r, "track", scene_->tracks.size());
    if (r.given("color")) track.color = color(r.at("color"));
    scene_->tracks.push_back(track);
  }

  const JsonDocument& document_;
  Diagnostics& faults_;
  Scene* scene_ = nullptr;
};

/// FNV-1a of the document with its overrides.
std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3u;
  }
  return hash;
}

}  // namespace

std::unique_ptr<Scene> read_scene(const std::string& file, const std::vector<std::string>& overrides,
                                  Diagnostics& diagnostics) {
  JsonDocument document = JsonDocument::read(file, diagnostics);
  for (const std::string& assignment : overrides) document.set(assignment, diagnostics);
  validate(document, scene_record(), diagnostics);
  diagnostics.throw_if_errors();
  std::unique_ptr<Scene> scene = SceneReader(document, diagnostics).read();
  diagnostics.throw_if_errors();
  std::string resolved = document.text();
  for (const std::string& assignment : overrides) resolved += "\n" + assignment;
  scene->hash = hash_of(resolved);
  scene->document = document.text();
  scene->overrides = overrides;
  return scene;
}

}  // namespace pliant
