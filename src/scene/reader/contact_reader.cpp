#include "contact_reader.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/part/local/local_deformation.h>
#include <pliant/scene/time_value.h>

#include "color_reader.h"
#include "direction_reader.h"

namespace pliant {

namespace {

schema::Record plane_record(const schema::Type& color) {
  using namespace schema;
  const Record shown{
      "shown",
      "A visible rectangle centred at the point of a plane.",
      {required("width", number(above(0), "m"),
                "Length of its horizontal sides; for a horizontal plane, the sides along x.", "1"),
       required("height", number(above(0), "m"), "Length of its other sides.", "1"),
       optional("color", color, "Colour in pictures.", "\"#9a9488\"")}};
  return {
      "plane",
      "An impenetrable half space behind a plane.",
      {required("name", name(), "Name that no part or other plane has.", "\"floor\""),
       optional("point", time_vector("m"), "A point of the plane; it may move in time.", "[0, 0, 0]"),
       optional("normal", vector3("1"), "Normal, pointing out of the half space.", "[0, 0, 1]"),
       optional("on", number(at_least(0), "s"), "Time at which the plane appears.", "0"),
       optional("off", number(above(0), "s"), "Time at which the plane disappears; when absent, never."),
       optional("shown", record(shown),
                "Rectangle that pictures and meshes show while the plane acts. The whole plane acts. When "
                "absent, the plane is invisible.")}};
}

schema::Record pair_record() {
  using namespace schema;
  return {
      "pair",
      "Contact of two parts, or of a part and a plane or an obstacle. A group stands for all its members.",
      {required("between", array(name(), 2, 2), "Two names of parts, planes, obstacles or groups.",
                "[\"ball\", \"floor\"]"),
       optional("touch", boolean(),
                "Whether the two touch. Parts tied by a joint touch only if a pair names both.", "true"),
       optional("friction", number(at_least(0), "1"),
                "Coulomb's coefficient of this pair; when absent, the coefficient of \"contact\"."),
       optional("restitution", number(between(0, 1), "1"),
                "Restitution of this pair; when absent, the restitution of \"contact\".")}};
}

schema::Record sleep_record() {
  using namespace schema;
  return {"sleep",
          "Sleep of bodies at rest. A sleeping body, and all bodies that it touches or is tied to, keep "
          "their state until something touches or drives one of them.",
          {required("speed", number(above(0), "m/s"), "Largest speed of a point of a body at rest.", "0.001"),
           optional("after", number(above(0), "s"), "Time at rest after which a body sleeps.", "0.5")}};
}

}  // namespace

schema::Record contact_record(const schema::Type& orientation, const schema::Type& color) {
  using namespace schema;
  return {
      "contact",
      "Contact of parts with planes, obstacles and each other. When absent, they pass through everything.",
      {optional("friction", number(at_least(0), "1"), "Coulomb's coefficient.", "0.5"),
       optional("restitution", number(between(0, 1), "1"),
                "Ratio of the normal speed after an impact to the speed before it.", "0"),
       optional(
           "impacts",
           choice({{"simultaneous",
                    "Newton's law holds at all contacts at once: in a row of balls that touch, all balls "
                    "after the first leave together"},
                   {"sequential",
                    "impacts of two bodies follow each other, the fastest first: in a row of equal balls "
                    "with restitution 1 only the last ball leaves"}}),
           "How impacts at the same time are resolved, for instance in Newton's cradle. The sequential order "
           "needs a restitution above 0. Without restitution, both orders give the same motion.",
           "\"simultaneous\""),
       optional(
           "tolerance", number(between(kMinContactTolerance, kMaxContactTolerance), "1"),
           "Accuracy of contact. The velocities at contacts violate Coulomb's and Newton's laws by at most "
           "this share of the largest speed that contact stops. At rest, this speed is the speed that "
           "gravity gives a body in a step. At an impact, this speed is (1 + restitution) times the speed of "
           "the impact. Overlaps up to a thousandth of the tolerance, in sizes of the smaller body, remain. "
           "But overlaps are at most half of the gap of resting contacts (normally 5e-7 sizes), so that "
           "tolerances above 5e-4 allow no deeper overlaps. At nodes of a mesh, overlaps up to 8e-4 sizes "
           "remain with any tolerance. When absent, velocities and overlaps are as exact as rounding "
           "allows."),
       optional("between_parts", boolean(), "Whether parts touch parts.", "true"),
       optional(
           "longest_step", number(above(0), "s"),
           "Longest step with a \"tolerance\" in lasting contact. It applies if the scene has \"forces\", "
           "if more than eight moving bodies may meet each other, or if a body deforms locally. In the last "
           "two cases the error "
           "of these contacts is not controlled. For tolerances above 5e-4 the longest step grows in "
           "proportion, up to ten times.",
           "0.002"),
       optional("interval", number(above(0), "s"),
                "With a \"tolerance\", bodies that may meet within an interval of this length step together, "
                "separately from all other bodies. Fast or small scenes need a shorter interval.",
                "0.0078125"),
       optional("sleep", record(sleep_record()), "Sleep of bodies at rest; when absent, no body sleeps."),
       optional("planes", array(record(plane_record(color))), "Impenetrable planes.", "[]"),
       optional("obstacles", array(record(obstacle_record(orientation, color))),
                "Immobile meshes and plates.", "[]"),
       optional("groups", map(array(name(), 1)),
                "For each group, the names of its parts, planes and obstacles.", "{}"),
       optional("pairs", array(record(pair_record())),
                "Pairs with settings of their own. If several pairs match, the pair with the fewest groups "
                "applies; among equals, the last one.",
                "[]")}};
}

namespace {

void read_plane(const Reader& r, const std::map<std::string, NamedPart>& parts, const TimeReader& times,
                SceneFaults& faults, Scene& scene) {
  MultiBody& body = scene.body;
  const std::optional<TimeVector> point =
      r.given("point") ? times.vector(r, "point", Needs::value_and_rate) : TimeVector(Vec3<double>(0, 0, 0));
  const Vec3<double> normal =
      r.given("normal") ? read_direction(r.at("normal"), faults) : Vec3<double>(0, 0, 1);
  if (r.given("off") && !(r.number("on") < r.number("off")))
    faults.value(r.at("off"), "expected a time after \"on\", which is " + brief(r.number("on")) + " s");
  if (!r.complete() || !point) return;
  const auto part = parts.find(r.text("name"));
  if (part != parts.end()) return faults.twice(*part->second.name, r.at("name"));
  for (const ContactPlane& other : body.contact.planes)
    if (other.name == r.text("name"))
      return faults.value(r.at("name"), "another plane has this name; expected a different name");
  ContactPlane& plane = body.plane(r.text("name"), *point, normal);
  plane.on = r.number("on");
  if (r.given("off")) plane.off = r.number("off");
  if (!r.given("shown")) return;
  const Reader shown = r.object("shown");
  if (shown.complete())
    scene.planes.push_back({body.contact.planes.size() - 1, shown.number("width"), shown.number("height"),
                            read_color(shown.at("color"))});
}

/// Returns whether all names of a list are known; each unknown name is reported.
bool are_known(const JsonValue& list, const char* kind, const std::vector<std::string>& known,
               SceneFaults& faults) {
  bool all = true;
  for (const JsonValue& name : list.array())
    if (std::find(known.begin(), known.end(), name.string()) == known.end()) {
      faults.unknown(name, kind, known);
      all = false;
    }
  return all;
}

/// Reads the groups into the settings. names: the names of all parts, planes and obstacles; the names of the
/// groups are appended.
void read_groups(const Reader& contact, std::vector<std::string>& names, SceneFaults& faults,
                 ContactSettings& settings) {
  if (!contact.given("groups")) return;
  const std::vector<std::string> things = names;
  const JsonValue& groups = contact.at("groups");
  for (const JsonValue::Member& group : groups.members()) {
    if (schema::is_ignored_key(group.key)) continue;
    names.push_back(group.key);
    if (contact.is_faulty(group.value)) continue;
    if (std::find(things.begin(), things.end(), group.key) != things.end())
      faults.key(groups, group.key, "a part, plane or obstacle has this name; expected a different name");
    if (!are_known(group.value, "part, plane or obstacle", things, faults)) continue;
    settings.groups.push_back({group.key, {}});
    for (const JsonValue& member : group.value.array())
      settings.groups.back().members.push_back(member.string());
  }
}

void read_pair(const Reader& r, const std::vector<std::string>& names, std::size_t n_things,
               SceneFaults& faults, ContactSettings& settings) {
  if (!r.complete() || !r.given("between")) return;
  const JsonValue& between = r.at("between");
  if (!are_known(between, "part, plane, obstacle or group", names, faults)) return;
  ContactPair pair;
  pair.a = between.array()[0].string();
  pair.b = between.array()[1].string();
  const auto things_end = names.begin() + static_cast<std::ptrdiff_t>(n_things);
  if (pair.a == pair.b && std::find(names.begin(), things_end, pair.a) != things_end)
    return faults.value(between.array()[1],
                        "this thing is named twice; expected two different things, or a group twice");
  pair.touch = r.boolean("touch");
  if (r.given("friction")) pair.friction = r.number("friction");
  if (r.given("restitution")) pair.restitution = r.number("restitution");
  settings.pairs.push_back(std::move(pair));
}

}  // namespace

void read_contact(const Reader& contact, const std::map<std::string, NamedPart>& parts,
                  const TimeReader& times, const MeshFolder& folder, SceneFaults& faults, Scene& scene) {
  MultiBody& body = scene.body;
  ContactSettings& settings = body.contact;
  settings.active = true;
  settings.friction = contact.number("friction");
  settings.restitution = contact.number("restitution");
  settings.impacts =
      contact.text("impacts") == "sequential" ? ImpactOrder::sequential : ImpactOrder::simultaneous;
  if (contact.given("tolerance")) settings.tolerance = contact.number("tolerance");
  settings.between_parts = contact.boolean("between_parts");
  settings.longest_step = contact.number("longest_step");
  settings.interval = contact.number("interval");
  if (contact.given("sleep")) {
    const Reader sleep = contact.object("sleep");
    if (sleep.complete()) settings.sleep = Sleep{sleep.number("speed"), sleep.number("after")};
  }
  for (const Reader& r : contact.objects("planes")) read_plane(r, parts, times, faults, scene);
  std::vector<std::string> names;
  for (const auto& [name, part] : parts) names.push_back(name);
  for (const ContactPlane& plane : settings.planes) names.push_back(plane.name);
  for (const Reader& r : contact.objects("obstacles")) {
    read_obstacle(r, names, folder, faults, scene);
    if (r.given("name")) names.push_back(r.text("name"));
  }
  const std::size_t n_things = names.size();
  read_groups(contact, names, faults, settings);
  for (const Reader& r : contact.objects("pairs")) read_pair(r, names, n_things, faults, settings);
}

}  // namespace pliant
