#include "contact_reader.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <pliant/part/local_deformation.h>
#include <pliant/scene/time_value.h>

#include "direction_reader.h"

namespace pliant {

schema::Record contact_record() {
  using namespace schema;
  const Record plane{
      "plane",
      "What lies behind a plane is solid.",
      {required("name", name(), "Name, that no part has.", "\"floor\""),
       optional("point", time_vector("m"), "A point on it; it may move in time.", "[0, 0, 0]"),
       optional("normal", vector3("1"), "Its direction, away from what is solid.", "[0, 0, 1]"),
       optional("on", number(at_least(0), "s"), "When it appears.", "0"),
       optional("off", number(above(0), "s"), "When it goes; never when not given.")}};
  const Record pair{
      "pair",
      "How two parts, or a part and a plane, touch.",
      {required("between", array(name(), 2, 2), "Their names.", "[\"ball\", \"floor\"]"),
       optional("touch", boolean(), "Whether they touch; parts that a joint ties do not but for this.",
                "true"),
       optional("friction", number(at_least(0), "1"), "As below \"contact\", where that is not given."),
       optional("restitution", number(between(0, 1), "1"), "Likewise.")}};
  return {"contact",
          "Parts touch planes and each other; when not given, they pass through everything.",
          {optional("friction", number(at_least(0), "1"), "Coulomb's coefficient.", "0.5"),
           optional("restitution", number(between(0, 1), "1"), "Speed after an impact over the speed before.",
                    "0"),
           optional("between_parts", boolean(), "Whether parts touch parts.", "true"),
           optional("planes", array(record(plane)), "Planes that nothing passes.", "[]"),
           optional("pairs", array(record(pair)), "Pairs that are out of the ordinary.", "[]")}};
}

namespace {

void read_plane(const Reader& r, const std::map<std::string, NamedPart>& parts, const TimeReader& times,
                SceneFaults& faults, MultiBody& body) {
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
      return faults.value(r.at("name"), "another plane has this name; expected one of its own");
  ContactPlane& plane = body.plane(r.text("name"), *point, normal);
  plane.on = r.number("on");
  if (r.given("off")) plane.off = r.number("off");
}

}  // namespace

void read_contact(const Reader& contact, const std::map<std::string, NamedPart>& parts,
                  const TimeReader& times, SceneFaults& faults, MultiBody& body) {
  for (const auto& [name, part] : parts)
    if (part.part != nullptr && part.prepared && part.part->local() != nullptr &&
        part.part->local()->nodal() == nullptr)
      faults.place(contact.json(),
                   "part \"" + name +
                       "\" deforms by modes of its whole body; contact is of parts that deform "
                       "at the nodes of a mesh, and of those that do not deform locally");
  ContactSettings& settings = body.contact;
  settings.active = true;
  settings.friction = contact.number("friction");
  settings.restitution = contact.number("restitution");
  settings.between_parts = contact.boolean("between_parts");
  for (const Reader& r : contact.objects("planes")) read_plane(r, parts, times, faults, body);
  std::vector<std::string> names;
  for (const auto& [name, part] : parts) names.push_back(name);
  for (const ContactPlane& plane : settings.planes) names.push_back(plane.name);
  for (const Reader& r : contact.objects("pairs")) {
    if (!r.complete() || !r.given("between")) continue;
    const JsonValue::Array& between = r.at("between").array();
    bool known = true;
    for (const JsonValue& name : between)
      if (std::find(names.begin(), names.end(), name.string()) == names.end()) {
        faults.unknown(name, "part or plane", names);
        known = false;
      }
    if (!known) continue;
    settings.pairs.push_back({between[0].string(), between[1].string(), r.boolean("touch"),
                              r.given("friction") ? r.number("friction") : settings.friction,
                              r.given("restitution") ? r.number("restitution") : settings.restitution});
  }
}

}  // namespace pliant
