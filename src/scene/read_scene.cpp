#include <pliant/scene/read_scene.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>

#include <pliant/math/nearest_name.h>
#include <pliant/part/registry.h>
#include <pliant/scene/json_document.h>
#include <pliant/scene/scene_schema.h>
#include <pliant/scene/validate.h>

#include "json_write.h"

namespace pliant {

namespace {

// Values whose type the schema has already checked.
double number(const JsonValue& object, const char* key, double otherwise) {
  const JsonValue* v = object.find(key);
  return v != nullptr ? v->number() : otherwise;
}
bool boolean(const JsonValue& object, const char* key, bool otherwise) {
  const JsonValue* v = object.find(key);
  return v != nullptr ? v->boolean() : otherwise;
}
std::string string(const JsonValue& object, const char* key, const std::string& otherwise = "") {
  const JsonValue* v = object.find(key);
  return v != nullptr ? v->string() : otherwise;
}
Vec3<double> vector(const JsonValue& v) {
  return {v.array()[0].number(), v.array()[1].number(), v.array()[2].number()};
}
Vec3<double> vector(const JsonValue& object, const char* key, const Vec3<double>& otherwise) {
  const JsonValue* v = object.find(key);
  return v != nullptr ? vector(*v) : otherwise;
}

TimeFunction time_function(const JsonValue& v) {
  if (v.is_number()) return v.number();
  if (v.is_string()) return TimeFunction::formula(v.string());
  std::vector<double> t, x;
  for (const JsonValue& entry : v.find("t")->array()) t.push_back(entry.number());
  for (const JsonValue& entry : v.find("x")->array()) x.push_back(entry.number());
  return TimeFunction::key_frames(std::move(t), std::move(x));
}
TimeVector time_vector(const JsonValue& v) {
  return {time_function(v.array()[0]), time_function(v.array()[1]), time_function(v.array()[2])};
}

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
    const JsonValue& root = document_.root();
    scene_->name = string(root, "name", std::filesystem::path(document_.name()).stem().string());
    scene_->description = string(root, "description");
    scene_->body.gravity = vector(root, "gravity", scene_->body.gravity);
    read_settings(root);
    each(root, "parts", [&](const JsonValue& v) { read_part(v); });
    each(root, "springs", [&](const JsonValue& v) { read_spring(v); });
    each(root, "forces", [&](const JsonValue& v) { read_force(v); });
    each(root, "torques", [&](const JsonValue& v) { read_torque(v); });
    each(root, "tracks", [&](const JsonValue& v) { read_track(v); });
    return scene;
  }

 private:
  template <class F>
  static void each(const JsonValue& object, const char* key, F&& f) {
    if (const JsonValue* list = object.find(key))
      for (const JsonValue& v : list->array()) f(v);
  }
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

  void read_settings(const JsonValue& root) {
    if (const JsonValue* time = root.find("time")) {
      scene_->end = number(*time, "end", scene_->end);
      scene_->step = number(*time, "step", scene_->step);
      scene_->integrator = string(*time, "integrator", scene_->integrator);
      if (scene_->end / scene_->step > 1e12)
        fault(*time, "end / step is more than 1e12 steps");
    }
    if (const JsonValue* output = root.find("output")) {
      scene_->frame_rate = number(*output, "frame_rate", scene_->frame_rate);
      if (const JsonValue* size = output->find("size")) {
        scene_->width = static_cast<int>(size->array()[0].number());
        scene_->height = static_cast<int>(size->array()[1].number());
      }
    }
    if (const JsonValue* camera = root.find("camera")) {
      if (const JsonValue* eye = camera->find("eye")) scene_->camera.eye = vector(*eye);
      if (const JsonValue* target = camera->find("target")) scene_->camera.target = vector(*target);
      scene_->camera.field_of_view = number(*camera, "field_of_view", scene_->camera.field_of_view);
    }
    if (const JsonValue* light = root.find("light")) {
      if (const JsonValue* direction = light->find("direction")) scene_->light.direction = direction_of(*direction);
      scene_->light.shadows = boolean(*light, "shadows", true);
    }
    if (const JsonValue* ground = root.find("ground")) {
      scene_->ground.visible = boolean(*ground, "visible", true);
      if (const JsonValue* height = ground->find("height")) scene_->ground.height = height->number();
    }
  }

  Vec3<double> direction_of(const JsonValue& v) {
    const Vec3<double> d = vector(v);
    if (!(d.norm() > 0)) {
      fault(v, "a direction of length 0");
      return {0, 0, 1};
    }
    return d;
  }

  void read_part(const JsonValue& v) {
    const std::string name = string(v, "name");
    if (scene_->body.find(name) != nullptr) {
      fault(*v.find("name"), "there is already a part called \"" + name + "\"; names must be unique");
      return;
    }
    std::vector<std::string> deformations;
    each(v, "deformations", [&](const JsonValue& d) { deformations.push_back(d.string()); });

    const JsonValue* material = nullptr;
    if (const JsonValue* reference = v.find("material")) {
      const JsonValue* materials = document_.root().find("materials");
      material = materials != nullptr ? materials->find(reference->string()) : nullptr;
      if (material == nullptr) {
        std::vector<std::string> names;
        if (materials != nullptr)
          for (const auto& member : materials->members()) names.push_back(member.key);
        fault(*reference, "no material is called \"" + reference->string() + "\"" + hint(reference->string(), names));
      }
    }
    auto property = [&](const char* key, double otherwise) {
      return number(v, key, material != nullptr ? number(*material, key, otherwise) : otherwise);
    };

    std::unique_ptr<Part> made;
    if (!attempt(v, [&] { made = make_part(name, string(v, "shape"), deformations, property("density", 1000)); })) return;
    Part& part = scene_->body.add(std::move(made));
    Appearance look;
    look.color = v.find("color") != nullptr ? color(*v.find("color")) : palette(scene_->appearance.size());
    look.resolution = static_cast<int>(number(v, "resolution", look.resolution));
    look.visible = boolean(v, "visible", true);
    scene_->appearance.push_back(look);

    if (boolean(v, "shell", false)) part.make_shell();
    part.damping(property("alpha", 0), property("beta", 0), property("drag", 0));
    if (const JsonValue* mass = v.find("mass")) part.mass(mass->number());
    bool good = true;
    if (const JsonValue* parameters = v.find("parameters")) good = read_parameters(part, *parameters);
    if (const JsonValue* K = v.find("stiffness_matrix")) good = read_stiffness(part, *K) && good;
    if (const JsonValue* inertia = v.find("inertia"))
      good = attempt(*inertia, [&] {
               Mat3<double> moments;
               for (int i = 0; i < 3; ++i)
                 moments.row(i) = vector(inertia->find("moments")->array()[static_cast<std::size_t>(i)]);
               part.inertia(number(*inertia, "mass", 1), moments, vector(*inertia, "centre", {0, 0, 0}));
             }) && good;
    Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
    if (const JsonValue* orientation = v.find("orientation")) R = read_orientation(*orientation);
    part.place(vector(v, "position", {0, 0, 0}), R);
    part.move(vector(v, "velocity", {0, 0, 0}), vector(v, "angular_velocity", {0, 0, 0}));
    if (boolean(v, "fixed", false)) part.fix();
    // Folding, limits and the like show when the constants are taken.
    if (good) attempt(v, [&] { part.prepare(); });
  }

  static std::string hint(const std::string& word, const std::vector<std::string>& names) {
    const std::string near = nearest_name(word, names);
    if (!near.empty()) return "; did you mean \"" + near + "\"?";
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
      if (v.is_number()) {
        good = attempt(v, [&] { part.rest({{name, v.number()}}); }) && good;
        continue;
      }
      if (const JsonValue* rest = v.find("rest"))
        good = attempt(*rest, [&] {
                 if (rest->is_number())
                   part.rest({{name, rest->number()}});
                 else
                   part.rest(name, time_function(*rest));
               }) && good;
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
        const Range range{number(v, "min", p.spec->dynamic.min * scale), number(v, "max", p.spec->dynamic.max * scale)};
        good = attempt(v, [&] { part.limits(name, range); }) && good;
        if (!p.dynamic) warn(v, "limits of " + name + " have no effect: it is frozen");
      }
    }
    return good;
  }

  bool read_stiffness(Part& part, const JsonValue& v) {
    std::vector<std::string> names;
    each(v, "parameters", [&](const JsonValue& n) { names.push_back(n.string()); });
    const auto& rows = v.find("K")->array();
    const auto n = static_cast<Eigen::Index>(names.size());
    MatX<double> K(n, n);
    for (const JsonValue& row : rows)
      if (static_cast<Eigen::Index>(rows.size()) != n || static_cast<Eigen::Index>(row.array().size()) != n) {
        fault(*v.find("K"), "K must have a row and a column for each of the " + std::to_string(n) + " parameters");
        return false;
      }
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        K(i, j) = rows[static_cast<std::size_t>(i)].array()[static_cast<std::size_t>(j)].number();
    return attempt(v, [&] { part.stiffness(names, K); });
  }

  Eigen::Quaterniond read_orientation(const JsonValue& v) {
    if (const JsonValue* axis = v.find("axis"))
      return Eigen::Quaterniond(Eigen::AngleAxisd(v.find("angle")->number(), direction_of(*axis).normalized()));
    const JsonValue& list = *v.find("quaternion");
    const auto& q = list.array();
    const Eigen::Quaterniond R(q[0].number(), q[1].number(), q[2].number(), q[3].number());
    if (!(R.norm() > 0)) {
      fault(list, "a quaternion of length 0 is no rotation");
      return Eigen::Quaterniond::Identity();
    }
    if (std::abs(R.norm() - 1) > 1e-3)
      warn(list, "its length is not 1; it is taken as the rotation of the same direction");
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

  Material<double> material_point(const Part& part, const JsonValue& v) {
    if (const JsonValue* u = v.find("u"))
      return material_at(u->number(), v.find("v")->number(), number(v, "w", 1));
    const bool torus = part.shape().mesh() == MeshPattern::torus;
    if (const JsonValue* direction = v.find("direction")) {
      if (torus) {
        fault(*direction, "a torus has no single point in a direction; give {\"u\", \"v\", \"w\"} or {\"near\"}");
        return {};
      }
      Material<double> m = part.label(direction_of(*direction).normalized() * part.size(), part.parameters().rest());
      m.w = number(v, "w", 1);
      return m;
    }
    Material<double> m = part.label(vector(*v.find("near")), part.parameters().rest());
    m.w = std::min(m.w, 1.0);
    return m;
  }

  /// Where a point is given as {"part", "at"}.
  bool point_on_part(const JsonValue& v, Point& point) {
    const Part* part = part_of(*v.find("part"));
    if (part == nullptr) return false;
    point.part = part;
    return attempt(*v.find("at"), [&] { point.material = material_point(*part, *v.find("at")); });
  }
  bool end_point(const JsonValue& v, Point& point) {
    if (const JsonValue* world = v.find("world")) {
      point.world = time_vector(*world);
      return true;
    }
    return point_on_part(v, point);
  }
  static std::string name_of(const JsonValue& v, const char* kind, std::size_t number) {
    return string(v, "name", kind + std::to_string(number + 1));
  }

  void read_spring(const JsonValue& v) {
    Point from, to;
    const bool a = end_point(*v.find("from"), from), b = end_point(*v.find("to"), to);
    if (!a || !b) return;
    if (from.part == nullptr && to.part == nullptr) {
      fault(v, "this spring ties the world to itself; one end must be on a part");
      return;
    }
    scene_->body.spring(name_of(v, "spring", scene_->body.springs().size()), from, to, number(v, "stiffness", 0),
                        number(v, "damping", 0), number(v, "rest_length", 0));
  }
  static Frame frame(const JsonValue& v) { return string(v, "frame") == "body" ? Frame::body : Frame::world; }
  void read_force(const JsonValue& v) {
    Point at;
    if (point_on_part(v, at))
      scene_->body.force(name_of(v, "force", scene_->body.forces().size()), at, time_vector(*v.find("force")), frame(v));
  }
  void read_torque(const JsonValue& v) {
    if (const Part* part = part_of(*v.find("part")))
      scene_->body.torque(name_of(v, "torque", scene_->body.torques().size()), *part, time_vector(*v.find("torque")),
                          frame(v));
  }
  void read_track(const JsonValue& v) {
    Track track;
    if (!point_on_part(v, track.point)) return;
    track.name = name_of(v, "track", scene_->tracks.size());
    if (const JsonValue* c = v.find("color")) track.color = color(*c);
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
  return scene;
}

}  // namespace pliant
