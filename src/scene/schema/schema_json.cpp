// Writing the JSON Schema (draft-07) of a scene from its records.
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include <pliant/scene/schema/schema.h>

namespace pliant::schema {

namespace {

using Json = nlohmann::ordered_json;

/// Returns the unit of the first number with a unit in a type, or an empty text if there is none. Fields of
/// records do not count.
std::string unit_of(const Type& type) {
  if (type.kind == Type::Kind::kNumber) return type.unit;
  for (const Type& inner : type.inner) {
    std::string unit = unit_of(inner);
    if (!unit.empty()) return unit;
  }
  return "";
}

class Writer {
 public:
  Json root(const Record& record) {
    Json body = object(record, "", "");
    body["properties"]["$schema"] = {{"type", "string"}, {"description", "This schema, for editors."}};
    Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", record.name}};
    schema.update(body);
    schema["definitions"] = definitions_;
    return schema;
  }

 private:
  Json type(const Type& t) {
    if (t.definition.empty()) return body(t);
    Json written = body(t);
    const auto known = definitions_.find(t.definition);
    if (known == definitions_.end()) {
      definitions_[t.definition] = std::move(written);
    } else if (*known != written) {
      throw std::logic_error("two types of a scene are defined as \"" + t.definition + "\"");
    }
    return {{"$ref", "#/definitions/" + t.definition}};
  }

  Json body(const Type& t) {
    switch (t.kind) {
      case Type::Kind::kNumber:
        return numeric("number", t.range);
      case Type::Kind::kInteger:
        return numeric("integer", t.range);
      case Type::Kind::kBoolean:
        return {{"type", "boolean"}};
      case Type::Kind::kText:
        return text(t);
      case Type::Kind::kName:
        return {{"type", "string"},
                {"minLength", t.min_count},
                {"maxLength", t.max_count},
                {"pattern", "^[^/\\u0000-\\u001f\\u007f]*$"}};
      case Type::Kind::kChoice:
        return choices(t);
      case Type::Kind::kArray:
        return array_body(t);
      case Type::Kind::kMap:
        return map_body(t);
      case Type::Kind::kRecord:
        return object(*t.records[0], "", "");
      case Type::Kind::kTagged: {
        Json alternatives = Json::array();
        for (const RecordPtr& r : t.records) alternatives.push_back(object(*r, t.tag, r->name));
        return {{"type", "object"}, {"required", {t.tag}}, {"oneOf", alternatives}};
      }
      case Type::Kind::kOneOf:
        break;
    }
    Json alternatives = Json::array();
    for (const Type& inner : t.inner) alternatives.push_back(type(inner));
    return {{"anyOf", alternatives}};
  }

  static Json numeric(const char* name, const Range& range) {
    Json out = {{"type", name}};
    if (std::isfinite(range.min)) out[range.min_excluded ? "exclusiveMinimum" : "minimum"] = range.min;
    if (std::isfinite(range.max)) out[range.max_excluded ? "exclusiveMaximum" : "maximum"] = range.max;
    return out;
  }

  static Json text(const Type& t) {
    Json out = {{"type", "string"}};
    if (t.min_count > 0) out["minLength"] = t.min_count;
    if (!t.pattern.empty()) out["pattern"] = t.pattern;
    return out;
  }

  static Json choices(const Type& t) {
    Json list = Json::array();
    for (const Choice& c : t.choices) list.push_back({{"const", c.word}, {"description", c.meaning}});
    return {{"type", "string"}, {"oneOf", list}};
  }

  Json array_body(const Type& t) {
    Json out = {{"type", "array"}, {"items", type(t.inner[0])}};
    if (t.min_count > 0) out["minItems"] = t.min_count;
    if (t.max_count != std::numeric_limits<std::size_t>::max()) out["maxItems"] = t.max_count;
    return out;
  }

  static Json ignored_keys() { return {{"^x-", Json::object()}, {"^//$", Json::object()}}; }

  Json map_body(const Type& t) {
    return {{"type", "object"},
            {"patternProperties", ignored_keys()},
            {"additionalProperties", type(t.inner[0])}};
  }

  Json field(const Field& f) {
    const Json written = type(f.type);
    std::string description = f.description;
    const std::string unit = unit_of(f.type);
    if (!unit.empty()) description += unit == "1" ? " Dimensionless." : " Unit: " + unit + ".";
    Json out = {{"description", description}};
    if (!f.default_text.empty()) out["default"] = Json::parse(f.default_text);
    if (!f.example.empty()) out["examples"] = Json::array({Json::parse(f.example)});
    if (written.contains("$ref")) {
      out["allOf"] = Json::array({written});  // draft-07 ignores all other keys of an object with $ref
    } else {
      out.update(written);
    }
    return out;
  }

  Json object(const Record& record, const std::string& tag, const std::string& value) {
    Json properties = Json::object();
    Json needed = Json::array();
    if (!tag.empty()) {
      properties[tag] = {{"description", record.description}, {"const", value}};
      needed.push_back(tag);
    }
    for (const Field& f : record.fields) {
      properties[f.key] = field(f);
      if (f.required) needed.push_back(f.key);
    }
    Json out = {{"description", record.description}, {"type", "object"}, {"properties", properties}};
    if (!needed.empty()) out["required"] = needed;
    out["patternProperties"] = ignored_keys();
    out["additionalProperties"] = false;
    if (!record.exclusive.empty()) out["allOf"] = groups(record);
    return out;
  }

  static Json groups(const Record& record) {
    const auto has = [](const std::string& key) { return Json{{"required", Json::array({key})}}; };
    Json all = Json::array();
    for (const KeyGroup& group : record.exclusive) {
      Json alternatives = Json::array(), absent = Json::array();
      for (const std::string& key : group.keys) {
        alternatives.push_back(has(key));
        absent.push_back(has(key));
      }
      if (!group.at_least_one) alternatives.push_back({{"not", {{"anyOf", absent}}}});
      all.push_back({{"oneOf", alternatives}});
    }
    return all;
  }

  Json definitions_ = Json::object();
};

}  // namespace

std::string schema_json(const Record& root) {
  return Writer().root(root).dump(2) + "\n";
}

}  // namespace pliant::schema
