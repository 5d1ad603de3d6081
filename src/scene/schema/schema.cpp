#include <pliant/scene/schema/schema.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "scene/json/json_parse.h"
#include "scene/json/json_write.h"

namespace pliant::schema {

namespace {

/// Returns the value of an example or a default value in the declaration of a key. Throws std::logic_error if
/// `text` is not JSON.
JsonValue parse_declared(const std::string& key, const std::string& text) {
  json::ParseOptions options;
  options.place = [](std::size_t offset) { return "character " + std::to_string(offset + 1); };
  options.report = [](const json::Fault& fault) { throw fault; };
  try {
    return json::parse(text, options);
  } catch (const json::Fault& fault) {
    throw std::logic_error("the declaration of \"" + key + "\" contains bad JSON: " + text + ": " +
                           fault.message);
  }
}

std::string words(const Range& range) {
  const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
  if (low && high) {
    return std::string(" in ") + (range.min_excluded ? "(" : "[") + shortest(range.min) + ", " +
           shortest(range.max) + (range.max_excluded ? ")" : "]");
  }
  if (low) return (range.min_excluded ? " > " : " >= ") + shortest(range.min);
  if (high) return (range.max_excluded ? " < " : " <= ") + shortest(range.max);
  return "";
}

std::string plural(const std::string& one) {
  for (const std::string_view article : {"a ", "an "}) {
    if (one.rfind(article, 0) == 0) {
      const std::size_t word = one.find(' ', article.size());
      const std::size_t end = word == std::string::npos ? one.size() : word;
      return one.substr(article.size(), end - article.size()) + "s" + one.substr(end);
    }
  }
  return "values, each " + one;
}

std::string array_words(const Type& type) {
  const std::string elements = plural(type.inner[0].words());
  if (type.min_count == type.max_count)
    return "an array of " + std::to_string(type.min_count) + " " + elements;
  const bool bounded = type.max_count != std::numeric_limits<std::size_t>::max();
  if (bounded && type.min_count == 0)
    return "an array of at most " + std::to_string(type.max_count) + " " + elements;
  if (bounded) {
    return "an array of " + std::to_string(type.min_count) + " to " + std::to_string(type.max_count) + " " +
           elements;
  }
  if (type.min_count <= 1)
    return (type.min_count == 1 ? "an array of one or more " : "an array of ") + elements;
  return "an array of at least " + std::to_string(type.min_count) + " " + elements;
}

std::string record_words(const Record& record) {
  std::string keys;
  for (const Field& field : record.fields) {
    if (!field.required) continue;
    keys += (keys.empty() ? "\"" : ", \"") + field.key + "\"";
  }
  return keys.empty() ? "an object" : "an object with " + keys;
}

bool accepts_objects(const Type& type) {
  using Kind = Type::Kind;
  if (type.kind == Kind::kOneOf) return std::any_of(type.inner.begin(), type.inner.end(), accepts_objects);
  return type.kind == Kind::kMap || type.kind == Kind::kRecord || type.kind == Kind::kTagged;
}

/// Returns how well a type fits the keys of an object: 1000 for each key that the type requires (or its tag),
/// 1 for each optional key. For a type with several alternatives, returns the best fit of an alternative.
int weight(const Type& type, const JsonValue& object) {
  if (type.kind == Type::Kind::kTagged) return object.find(type.tag) != nullptr ? 1000 : 0;
  if (type.kind == Type::Kind::kRecord) {
    int sum = 0;
    for (const JsonValue::Member& member : object.members()) {
      const Field* field = type.records[0]->find(member.key);
      if (field != nullptr) sum += field->required ? 1000 : 1;
    }
    return sum;
  }
  int best = 0;
  if (type.kind != Type::Kind::kOneOf) return best;
  for (const Type& inner : type.inner) best = std::max(best, weight(inner, object));
  return best;
}

}  // namespace

bool Range::contains(double x) const {
  return (min_excluded ? x > min : x >= min) && (max_excluded ? x < max : x <= max);
}
Range unbounded() {
  return {};
}
Range at_least(double min) {
  Range r;
  r.min = min;
  return r;
}
Range above(double min) {
  Range r = at_least(min);
  r.min_excluded = true;
  return r;
}
Range at_most(double max) {
  Range r;
  r.max = max;
  return r;
}
Range below(double max) {
  Range r = at_most(max);
  r.max_excluded = true;
  return r;
}
Range between(double min, double max) {
  Range r;
  r.min = min;
  r.max = max;
  return r;
}

Type Type::expecting(std::string words) const {
  Type t = *this;
  t.expected = std::move(words);
  return t;
}
Type Type::defined_as(std::string name) const {
  Type t = *this;
  t.definition = std::move(name);
  return t;
}
Type Type::matching(std::string regular_expression) const {
  Type t = *this;
  t.pattern = std::move(regular_expression);
  return t;
}
Type Type::checked(Check rule) const {
  Type t = *this;
  t.check = std::move(rule);
  return t;
}

std::string Type::words() const {
  if (!expected.empty()) return expected;
  switch (kind) {
    case Kind::kNumber:
      return "a number" + schema::words(range) + (unit.empty() || unit == "1" ? "" : " (" + unit + ")");
    case Kind::kInteger:
      return "an integer" + schema::words(range);
    case Kind::kBoolean:
      return "true or false";
    case Kind::kText:
      return min_count > 0 ? "a text in quotes that is not empty" : "a text in quotes";
    case Kind::kName:
      return "a name in quotes, without \"/\" and control characters, of 1 to 100 bytes";
    case Kind::kChoice: {
      std::string list;
      for (const Choice& c : choices) list += (list.empty() ? "\"" : ", \"") + c.word + "\"";
      return choices.size() == 1 ? list : "one of " + list;
    }
    case Kind::kArray:
      return array_words(*this);
    case Kind::kMap:
      return "an object from names to " + plural(inner[0].words());
    case Kind::kRecord:
      return record_words(*records[0]);
    case Kind::kTagged:
      return "an object with \"" + tag + "\"";
    case Kind::kOneOf:
      break;
  }
  std::string list;
  for (std::size_t i = 0; i < inner.size(); ++i) {
    list += (i == 0 ? "" : i + 1 == inner.size() ? " or " : ", ") + inner[i].words();
  }
  return list;
}

Type number(Range range, std::string unit) {
  Type t{Type::Kind::kNumber};
  t.range = range;
  t.unit = std::move(unit);
  return t;
}
Type integer(Range range) {
  Type t{Type::Kind::kInteger};
  t.range = range;
  return t;
}
Type boolean() {
  return {Type::Kind::kBoolean};
}
Type text(std::size_t min_count) {
  Type t{Type::Kind::kText};
  t.min_count = min_count;
  return t;
}
Type name() {
  Type t{Type::Kind::kName};
  t.min_count = 1;
  t.max_count = 100;
  return t;
}
Type choice(std::vector<Choice> choices) {
  Type t{Type::Kind::kChoice};
  t.choices = std::move(choices);
  return t;
}
Type array(Type element, std::size_t min_count, std::size_t max_count) {
  Type t{Type::Kind::kArray};
  t.inner.push_back(std::move(element));
  t.min_count = min_count;
  t.max_count = max_count;
  return t;
}
Type vector3(const std::string& unit, Range range) {
  Type t = array(number(range, unit), 3, 3);
  return t.expecting("3 numbers [x, y, z]" + words(range) +
                     (unit.empty() || unit == "1" ? "" : " (" + unit + ")"));
}
Type map(Type element) {
  Type t{Type::Kind::kMap};
  t.inner.push_back(std::move(element));
  return t;
}
Type record(Record fields) {
  Type t{Type::Kind::kRecord};
  t.definition = fields.name;
  t.records.push_back(std::make_shared<const Record>(std::move(fields)));
  return t;
}
Type tagged(std::string tag, std::vector<Record> records) {
  Type t{Type::Kind::kTagged};
  t.tag = std::move(tag);
  for (Record& r : records) t.records.push_back(std::make_shared<const Record>(std::move(r)));
  return t;
}
Type one_of(std::vector<Type> alternatives) {
  Type t{Type::Kind::kOneOf};
  t.inner = std::move(alternatives);
  return t;
}

Field required(std::string key, Type type, std::string description, std::string example) {
  if (!example.empty()) parse_declared(key, example);
  Field f{std::move(key), std::move(type), std::move(description), true};
  f.example = std::move(example);
  return f;
}

Field optional(std::string key, Type type, std::string description, std::string default_text) {
  Field f{std::move(key), std::move(type), std::move(description), false};
  if (!default_text.empty()) {
    f.default_value = std::make_shared<const JsonValue>(parse_declared(f.key, default_text));
  }
  f.default_text = std::move(default_text);
  return f;
}

const Field* Record::find(const std::string& key) const {
  for (const Field& field : fields) {
    if (field.key == key) return &field;
  }
  return nullptr;
}

const Type* chosen_alternative(const Type& one_of, const JsonValue& object) {
  const Type* best = nullptr;
  const Type* only = nullptr;
  int best_weight = 0, candidates = 0;
  for (const Type& inner : one_of.inner) {
    if (!accepts_objects(inner)) continue;
    only = &inner;
    ++candidates;
    const int inner_weight = weight(inner, object);
    if (inner_weight > best_weight) {
      best = &inner;
      best_weight = inner_weight;
    }
  }
  return candidates == 1 ? only : best;
}

bool is_ignored_key(const std::string& key) {
  return key == "//" || key.rfind("x-", 0) == 0;
}

}  // namespace pliant::schema
