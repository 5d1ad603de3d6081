#include "parameter_reader.h"

#include <algorithm>
#include <optional>

#include <pliant/part/registry.h>

#include "scene/json/json_write.h"

namespace pliant {

namespace {

/// Returns the words for an expected number: "a number in [0.1, 1.9] (m)".
std::string words(const Range& range, const char* unit) {
  return schema::number(schema::between(range.min, range.max), unit).words();
}

}  // namespace

void ParameterReader::read(const Reader& part) {
  const JsonValue* parameters = part.json().find("parameters");
  if (parameters == nullptr || !parameters->is_object()) return;
  for (const JsonValue::Member& member : parameters->members()) {
    if (schema::is_ignored_key(member.key)) continue;
    if (part_.parameters().find(member.key) < 0) {
      unknown(*parameters, member.key);
    } else if (!part.is_faulty(member.value)) {
      read(entry(member.key, member.value));
    }
  }
}

ParameterReader::Entry ParameterReader::entry(const std::string& name, const JsonValue& value) const {
  const auto find = [&](const char* key) { return value.is_object() ? value.find(key) : nullptr; };
  const bool in_matrix = std::count(in_matrix_.begin(), in_matrix_.end(), name) > 0;
  const JsonValue *flag = find("dynamic"), *initial = find("initial"), *stiffness = find("stiffness");
  const bool dynamic = in_matrix || initial != nullptr || stiffness != nullptr || find("drive") != nullptr ||
                       find("initial_rate") != nullptr || (flag != nullptr && flag->boolean());
  return {part_.parameters()[part_.parameters().find(name)],
          value,
          value.is_object() ? value.find("rest") : &value,
          initial,
          stiffness,
          find("min"),
          find("max"),
          flag,
          in_matrix,
          dynamic};
}

void ParameterReader::unknown(const JsonValue& parameters, const std::string& name) {
  const Parameters& known = part_.parameters();
  std::vector<std::string> names;
  std::string longer;  // the name with its deformation, for example taper.tx for tx
  for (int i = 0; i < known.size(); ++i) {
    names.push_back(known[i].name);
    const std::size_t dot = known[i].name.find('.');
    if (longer.empty() && dot != std::string::npos && known[i].name.substr(dot + 1) == name)
      longer = known[i].name;
  }
  std::string hint = longer.empty() ? name_hint(name, names) : "; did you mean \"" + longer + "\"?";
  const std::string link = name.substr(0, name.find('.'));
  const auto is_link = [&](const DeformationInfo& info) { return info.name == link; };
  const auto has_link = [&](const LinkInfo& info) { return info.type == link; };
  const auto& all = all_deformations();
  const auto& links = known.links();
  if (link != name && std::any_of(all.begin(), all.end(), is_link) &&
      std::none_of(links.begin(), links.end(), has_link))
    hint = "; the \"deformations\" of the part have no \"" + link + "\"";
  faults_.key(parameters, name, "unknown parameter of a " + std::string(part_.shape().name()) + hint);
}

void ParameterReader::read(const Entry& e) {
  if (contradicts(e) || !read_rest(e)) return;
  const std::string& name = e.parameter.name;
  if (e.dynamic) part_.make_dynamic({name});
  if (e.stiffness != nullptr) part_.stiffness({{name, e.stiffness->number()}});
  if (e.initial != nullptr) part_.initial({{name, e.initial->number()}});
  if (const JsonValue* rate = e.value.is_object() ? e.value.find("initial_rate") : nullptr)
    part_.initial_rate({{name, rate->number()}});
  read_limits(e);
}

bool ParameterReader::contradicts(const Entry& e) {
  const std::string& name = e.parameter.name;
  if (e.dynamic && e.flag != nullptr && !e.flag->boolean()) {
    std::string because = "a row of \"stiffness_matrix\"";
    for (const char* key : {"initial", "initial_rate", "stiffness", "drive"})
      if (e.value.find(key) != nullptr) because = std::string("\"") + key + "\"";
    faults_.value(*e.flag, name + " has " + because + ", which only a dynamic parameter has; expected true");
    return true;
  }
  if (e.stiffness != nullptr && e.in_matrix) {
    faults_.value(*e.stiffness,
                  name + " has a row of \"stiffness_matrix\" too; expected only one of the two");
    return true;
  }
  return false;
}

bool ParameterReader::read_rest(const Entry& e) {
  if (e.rest == nullptr) return true;
  const ParameterSpec& spec = *e.parameter.spec;
  const std::optional<TimeFunction> f = times_.function(*e.rest, Needs::value_and_rate);
  if (!f) return false;
  const double now = f->value(0);
  const bool narrowed = e.dynamic && !spec.relative;
  const Range& allowed = narrowed ? spec.dynamic : spec.frozen;
  if (!allowed.contains(now)) {
    const std::string start = f->is_constant() ? "" : "it is " + shortest(now) + " at time 0; ";
    const std::string why = narrowed && spec.frozen.contains(now)
                                ? " for a dynamic " + e.parameter.name + " (a frozen one may be in [" +
                                      shortest(spec.frozen.min) + ", " + shortest(spec.frozen.max) + "])"
                                : "";
    faults_.value(*e.rest, start + "expected " + words(allowed, spec.unit()) + why);
    return false;
  }
  if (!e.dynamic && !f->is_constant()) {
    faults_.value(*e.rest, "it changes in time, but " + e.parameter.name +
                               " is frozen; expected a number, or \"dynamic\": true");
    return false;
  }
  part_.rest(e.parameter.name, *f);
  return true;
}

/// Returns whether the given limits are within the range of the parameter and in ascending order; faults are
/// reported.
bool ParameterReader::admissible(const Entry& e, const Range& allowed) {
  const std::size_t before = faults_.errors();
  for (const JsonValue* limit : {e.min, e.max}) {
    if (limit == nullptr || allowed.contains(limit->number())) continue;
    faults_.value(
        *limit,
        "expected " + words(allowed, e.parameter.spec->unit()) +
            (e.parameter.spec->relative ? ", from a thousandth to a thousand times the rest value" : ""));
  }
  if (faults_.errors() > before) return false;
  if (e.min != nullptr && e.max != nullptr && !(e.min->number() < e.max->number())) {
    faults_.value(*e.max, "expected more than the lower limit, " + shortest(e.min->number()));
    return false;
  }
  return true;
}

void ParameterReader::read_limits(const Entry& e) {
  const double rest = e.parameter.rest_value();
  const double scale = e.parameter.spec->relative ? rest : 1.0;
  Range range{e.parameter.spec->dynamic.min * scale, e.parameter.spec->dynamic.max * scale};
  if (e.min != nullptr || e.max != nullptr) {
    if (!admissible(e, range)) return;
    if (e.min != nullptr) range.min = e.min->number();
    if (e.max != nullptr) range.max = e.max->number();
    if (!e.dynamic) {
      faults_.warn(e.min != nullptr ? *e.min : *e.max,
                   "this limit has no effect, because " + e.parameter.name + " is frozen");
      return;
    }
  }
  if (!e.dynamic) return;
  const std::string between = "[" + shortest(range.min) + ", " + shortest(range.max) + "]";
  if (!range.contains(rest)) {
    if (e.rest != nullptr)
      return faults_.value(*e.rest, "expected a rest value within the limits, " + between);
    const bool below = e.min != nullptr && rest < range.min;
    return faults_.value(below ? *e.min : *e.max, std::string("expected at ") + (below ? "most" : "least") +
                                                      " the rest value, " + shortest(rest));
  }
  if (e.initial != nullptr && !range.contains(e.initial->number()))
    return faults_.value(*e.initial, "expected an initial value within the limits, " + between);
  if (e.min != nullptr || e.max != nullptr) part_.limits(e.parameter.name, range);
}

}  // namespace pliant
