#include <pliant/scene/validate.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <pliant/math/nearest_name.h>
#include <pliant/scene/faulty_values.h>

#include "scene/json/json_write.h"

namespace pliant {

namespace {

using schema::Field;
using schema::Record;
using schema::Type;
using TypeKind = Type::Kind;
using ValueKind = JsonValue::Kind;

/// For each key, the records that declare the key, as patterns of JSON pointers, for example "/parts/*".
using Places = std::map<std::string, std::vector<std::string>>;

/// Adds the keys of all records inside a type. at: pointer pattern of the values of this type.
void collect(const Type& type, const std::string& at, Places* places);

/// Adds the keys of a record. note: text after the pattern, for example `of type "rod"`.
void collect(const Record& record, const std::string& at, const std::string& note, Places* places) {
  for (const Field& field : record.fields) {
    std::vector<std::string>& known = (*places)[field.key];
    const std::string place = at.empty() ? "the top of the scene" : at + note;
    if (std::find(known.begin(), known.end(), place) == known.end()) known.push_back(place);
    collect(field.type, pointer_join(at, field.key), places);
  }
}

void collect(const Type& type, const std::string& at, Places* places) {
  if (type.kind == TypeKind::kRecord) collect(*type.records[0], at, "", places);
  if (type.kind == TypeKind::kTagged) {
    for (const schema::RecordPtr& record : type.records) {
      collect(*record, at, " of " + type.tag + " \"" + record->name + "\"", places);
    }
  }
  const bool many = type.kind == TypeKind::kArray || type.kind == TypeKind::kMap;
  for (const Type& inner : type.inner) collect(inner, many ? at + "/*" : at, places);
}

/// Returns whether a type has values of this JSON kind.
bool accepts(const Type& type, ValueKind kind) {
  switch (type.kind) {
    case TypeKind::kNumber:
    case TypeKind::kInteger:
      return kind == ValueKind::kNumber;
    case TypeKind::kBoolean:
      return kind == ValueKind::kBoolean;
    case TypeKind::kText:
    case TypeKind::kName:
    case TypeKind::kChoice:
      return kind == ValueKind::kString;
    case TypeKind::kArray:
      return kind == ValueKind::kArray;
    case TypeKind::kMap:
    case TypeKind::kRecord:
    case TypeKind::kTagged:
      return kind == ValueKind::kObject;
    case TypeKind::kOneOf:
      break;
  }
  return std::any_of(type.inner.begin(), type.inner.end(), [&](const Type& t) { return accepts(t, kind); });
}

bool has_control_byte(const std::string& text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

/// Checks a value against a type, recursively.
class Validator {
 public:
  Validator(const JsonDocument& document, Diagnostics& faults)
      : document_(document), faults_(faults), reported_(faulty_values(document, faults)) {}

  void run(const JsonValue& value, const Type& type, std::string pointer, bool root) {
    root_type_ = &type;
    root_pointer_ = pointer;
    pointer_ = std::move(pointer);
    root_ = root ? &value : nullptr;
    check(value, type);
  }

 private:
  /// Extends the pointer by one key or index during its lifetime.
  struct Step {
    template <class Key>
    Step(Validator* validator, const Key& key) : v(validator), length(v->pointer_.size()) {
      v->pointer_ = pointer_join(v->pointer_, key);
    }
    ~Step() { v->pointer_.resize(length); }
    Step(const Step&) = delete;
    Step& operator=(const Step&) = delete;
    Validator* v;
    std::size_t length;
  };

  void fault(JsonPlace place, const std::string& pointer, std::string message) {
    faults_.add(document_.fault_at(place, pointer, std::move(message)));
  }
  void expected(const JsonValue& value, const std::string& words, const std::string& hint = "") {
    fault(value.place(), pointer_, document_.shown(value) + "; expected " + words + hint);
  }

  void check(const JsonValue& value, const Type& type) {
    if (faults_.full() || is_reported(value)) return;
    if (!accepts(type, value.kind())) return wrong_type(value, type);
    const std::size_t before = faults_.errors();
    switch (type.kind) {
      case TypeKind::kNumber:
        if (!type.range.contains(value.number())) expected(value, type.words());
        break;
      case TypeKind::kInteger:
        check_integer(value, type);
        break;
      case TypeKind::kBoolean:
        break;
      case TypeKind::kText:
        if (value.string().size() < type.min_count) expected(value, type.words());
        break;
      case TypeKind::kName:
        check_name(value, type);
        break;
      case TypeKind::kChoice:
        check_choice(value, type);
        break;
      case TypeKind::kArray:
        check_array(value, type);
        break;
      case TypeKind::kMap:
        for (const JsonValue::Member& member : value.members()) {
          if (schema::is_ignored_key(member.key)) continue;
          const Step step(this, member.key);
          check(member.value, type.inner[0]);
        }
        break;
      case TypeKind::kRecord:
        check_record(value, *type.records[0], "");
        break;
      case TypeKind::kTagged:
        check_tagged(value, type);
        break;
      case TypeKind::kOneOf:
        check_one_of(value, type);
        break;
    }
    if (type.check && faults_.errors() == before) run_rule(value, type);
  }

  /// Returns whether the parser has already reported a fault of this number or text.
  bool is_reported(const JsonValue& value) const {
    return !value.is_array() && !value.is_object() && reported_.count(&value) > 0;
  }

  void wrong_type(const JsonValue& value, const Type& type) {
    std::string hint;
    const bool number_in_quotes = value.is_string() && accepts(type, ValueKind::kNumber);
    const bool word_in_quotes = value.is_string() && type.kind == TypeKind::kBoolean;
    if (number_in_quotes || word_in_quotes) hint = ", not in quotes";
    if (type.kind == TypeKind::kBoolean && value.is_number()) hint = ", not a number";
    const bool alone = type.kind == TypeKind::kArray && type.min_count <= 1 && !value.is_object() &&
                       accepts(type.inner[0], value.kind());
    if (alone) hint = "; did you mean [" + document_.shown(value) + "]?";
    expected(value, type.words(), hint);
  }

  void run_rule(const JsonValue& value, const Type& type) {
    type.check(value, [&](const JsonValue& where, const std::string& message, std::size_t byte) {
      const JsonPlace place =
          byte == schema::kWholeValue ? where.place() : document_.place_in_string(where, byte);
      std::string pointer = pointer_;
      if (&where != &value) pointer = document_.pointer_to(where);
      fault(place, pointer, document_.shown(where) + "; " + message);
    });
  }

  void check_integer(const JsonValue& value, const Type& type) {
    constexpr double kExact = 9007199254740992.0;  // 2^53: larger doubles do not represent every integer
    const double x = value.number();
    if (x != std::floor(x) || !type.range.contains(x)) return expected(value, type.words());
    if (std::abs(x) > kExact) expected(value, type.words(), " of at most 9007199254740992 in magnitude");
  }

  void check_name(const JsonValue& value, const Type& type) {
    const std::string& text = value.string();
    const bool sound = text.size() >= type.min_count && text.size() <= type.max_count &&
                       text.find('/') == std::string::npos && !has_control_byte(text);
    if (!sound) expected(value, type.words());
  }

  void check_choice(const JsonValue& value, const Type& type) {
    std::vector<std::string> words;
    for (const schema::Choice& c : type.choices) words.push_back(c.word);
    if (std::find(words.begin(), words.end(), value.string()) != words.end()) return;
    expected(value, type.words(), did_you_mean(value.string(), words));
  }

  void check_array(const JsonValue& value, const Type& type) {
    const std::size_t n = value.array().size();
    if (n < type.min_count || n > type.max_count) return expected(value, type.words());
    for (std::size_t i = 0; i < n && !faults_.full(); ++i) {
      const Step step(this, i);
      check(value.array()[i], type.inner[0]);
    }
  }

  void check_tagged(const JsonValue& value, const Type& type) {
    std::vector<std::string> names;
    std::string list;
    for (const schema::RecordPtr& record : type.records) {
      names.push_back(record->name);
      list += (list.empty() ? "\"" : ", \"") + record->name + "\"";
    }
    const JsonValue* tag = value.find(type.tag);
    if (tag == nullptr) {
      return fault(value.place(), pointer_, "missing key \"" + type.tag + "\"; expected one of " + list);
    }
    const Step step(this, type.tag);
    const std::string word = tag->is_string() ? tag->string() : "";
    const auto chosen = std::find(names.begin(), names.end(), word);
    if (chosen == names.end()) return expected(*tag, "one of " + list, did_you_mean(word, names));
    pointer_.resize(step.length);
    check_record(value, *type.records[static_cast<std::size_t>(chosen - names.begin())], type.tag);
  }

  void check_record(const JsonValue& value, const Record& record, const std::string& tag) {
    std::vector<std::string> misspelt;
    const Type* alternatives = std::exchange(alternatives_, nullptr);
    for (const JsonValue::Member& member : value.members()) {
      if (faults_.full()) return;
      const bool ignored = schema::is_ignored_key(member.key) || (!tag.empty() && member.key == tag) ||
                           (&value == root_ && member.key == "$schema");
      if (ignored) continue;
      const Field* field = record.find(member.key);
      if (field == nullptr && alternatives != nullptr && known_to(*alternatives, member.key)) {
        fault(member.key_place, pointer_join(pointer_, member.key),
              "given beside " + given_of(record, value) + "; expected " + alternatives->words());
        continue;
      }
      if (field == nullptr) {
        misspelt.push_back(unknown_key(member, record, tag));
        continue;
      }
      const Step step(this, member.key);
      check(member.value, field->type);
    }
    for (const Field& field : record.fields) {
      if (!field.required || value.find(field.key) != nullptr) continue;
      if (std::find(misspelt.begin(), misspelt.end(), field.key) != misspelt.end()) continue;
      fault(value.place(), pointer_,
            "missing key \"" + field.key + "\"; expected " + field.type.words() +
                (field.example.empty() ? "" : ", for example \"" + field.key + "\": " + field.example));
    }
    for (const schema::KeyGroup& group : record.exclusive) check_group(value, group);
  }

  /// Returns "; did you mean ...?" for the first key of an object that is similar to a key of an alternative;
  /// an empty text if there is none.
  static std::string nearest_key(const JsonValue& object, const Type& alternatives) {
    std::vector<std::string> keys;
    for (const Type& t : alternatives.inner) {
      if (t.kind != TypeKind::kRecord) continue;
      for (const Field& field : t.records[0]->fields) keys.push_back(field.key);
    }
    for (const JsonValue::Member& member : object.members()) {
      if (schema::is_ignored_key(member.key)) continue;
      const std::string hint = did_you_mean(member.key, keys);
      if (!hint.empty()) return hint;
    }
    return "";
  }
  /// Returns whether a record of one of the alternatives has the key.
  static bool known_to(const Type& alternatives, const std::string& key) {
    return std::any_of(alternatives.inner.begin(), alternatives.inner.end(), [&](const Type& t) {
      return t.kind == TypeKind::kRecord && t.records[0]->find(key) != nullptr;
    });
  }
  /// Returns the required keys of a record that an object has, as a list in quotes.
  static std::string given_of(const Record& record, const JsonValue& object) {
    std::string list;
    for (const Field& field : record.fields)
      if (field.required && object.find(field.key) != nullptr)
        list += (list.empty() ? "\"" : ", \"") + field.key + "\"";
    return list;
  }

  void check_group(const JsonValue& value, const schema::KeyGroup& group) {
    std::string list;
    for (const std::string& key : group.keys) list += (list.empty() ? "\"" : ", \"") + key + "\"";
    const JsonValue::Member* first = nullptr;
    for (const JsonValue::Member& member : value.members()) {
      if (std::find(group.keys.begin(), group.keys.end(), member.key) == group.keys.end()) continue;
      if (first != nullptr && member.key != first->key) {
        fault(member.key_place, pointer_join(pointer_, member.key),
              "given beside \"" + first->key + "\"; expected only one of " + list);
      }
      if (first == nullptr) first = &member;
    }
    if (first == nullptr && group.at_least_one) {
      fault(value.place(), pointer_, "missing key; expected one of " + list);
    }
  }

  /// Reports an unknown key. Returns the most similar key of the record, or an empty text if none is similar.
  std::string unknown_key(const JsonValue::Member& member, const Record& record, const std::string& tag) {
    std::vector<std::string> keys;
    if (!tag.empty()) keys.push_back(tag);
    for (const Field& field : record.fields) keys.push_back(field.key);
    if (places_.empty()) collect(*root_type_, root_pointer_, &places_);
    std::string hint;
    const std::string near = nearest_name(member.key, keys);
    const bool slip = !near.empty() && edit_distance(member.key, near) == 1;
    const auto elsewhere = places_.find(member.key);
    if (elsewhere != places_.end() && !slip) {
      const std::size_t shown = std::min<std::size_t>(elsewhere->second.size(), 2);
      for (std::size_t i = 0; i < shown; ++i)
        hint += (i == 0 ? "; it belongs to " : " or ") + elsewhere->second[i];
      if (elsewhere->second.size() > shown) hint += " and others";
    }
    hint += did_you_mean(member.key, keys);
    if (hint.empty()) {
      std::string list;
      for (const std::string& key : keys) list += (list.empty() ? "\"" : ", \"") + key + "\"";
      hint = keys.empty() ? "; expected no keys" : "; expected one of " + list;
    }
    fault(member.key_place, pointer_join(pointer_, member.key), "unknown key" + hint);
    return near;
  }

  void check_one_of(const JsonValue& value, const Type& type) {
    std::vector<const Type*> candidates;
    for (const Type& inner : type.inner) {
      if (accepts(inner, value.kind())) candidates.push_back(&inner);
    }
    if (candidates.size() == 1) return check(value, *candidates[0]);
    if (value.is_object()) {
      const Type* chosen = schema::chosen_alternative(type, value);
      if (chosen == nullptr) return expected(value, type.words(), nearest_key(value, type));
      if (chosen->kind == TypeKind::kRecord) alternatives_ = &type;
      return check(value, *chosen);
    }
    std::size_t fewest = 0;
    const Type* nearest = nullptr;
    for (const Type* candidate : candidates) {
      Diagnostics trial;
      Validator(document_, trial).run(value, *candidate, pointer_, false);
      if (trial.errors() == 0) return;
      if (nearest == nullptr || trial.errors() < fewest) {
        nearest = candidate;
        fewest = trial.errors();
      }
    }
    if (value.is_array()) return check(value, *nearest);
    expected(value, type.words());
  }

  const JsonDocument& document_;
  Diagnostics& faults_;
  FaultyValues reported_;
  Places places_;  ///< computed at the first unknown key
  const Type* root_type_ = nullptr;
  const Type* alternatives_ =
      nullptr;  ///< the alternatives that contain the record to be checked next, or null
  std::string root_pointer_;
  std::string pointer_;
  const JsonValue* root_ = nullptr;
};

}  // namespace

void validate(const JsonDocument& document, const schema::Record& root, Diagnostics& faults) {
  const Type type = schema::record(root);
  Validator(document, faults).run(document.root(), type, "", true);
}

void validate(const JsonDocument& document, const JsonValue& value, const schema::Type& type,
              Diagnostics& faults) {
  Validator(document, faults).run(value, type, document.pointer_to(value), false);
}

}  // namespace pliant
