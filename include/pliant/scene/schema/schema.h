// What a scene may say, as data: records of keys with types, ranges, units, defaults and meanings. Checking a
// scene, reading it and its JSON Schema all follow from the same records.
//
//   Record part{"part", "A deformable solid.",
//               {required("name", name(), "Name of the part, unique in the scene."),
//                optional("density", number(above(0), "kg/m^3"), "Mass per rest volume.", "1000"),
//                optional("drag", time_function("1/s"), "Damping in proportion to mass.", "0")}};
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/scene/json/json_value.h>

namespace pliant::schema {

/// Numbers that are allowed.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
  bool max_excluded = false;

  bool contains(double x) const;
};
Range unbounded();
Range at_least(double min);
Range above(double min);
Range at_most(double max);
Range below(double max);
Range between(double min, double max);

struct Record;
using RecordPtr = std::shared_ptr<const Record>;

/// A word that may be chosen, and what it means.
struct Choice {
  std::string word;
  std::string meaning;
};

/// For ReportAt: the fault is at the beginning of the value.
inline constexpr std::size_t kWholeValue = static_cast<std::size_t>(-1);
/// Reports a fault at the value that is checked or one inside it, or at a byte of a string's text.
using ReportAt = std::function<void(const JsonValue& where, const std::string& message, std::size_t byte)>;
/// A rule beyond types and ranges; called only for a value whose type, ranges and keys are right.
using Check = std::function<void(const JsonValue& value, const ReportAt& report)>;

/// What a value may be. Made by the functions below.
struct Type {
  enum class Kind {
    kNumber,
    kInteger,
    kBoolean,
    kText,
    kName,
    kChoice,
    kArray,
    kMap,
    kRecord,
    kTagged,
    kOneOf
  };

  Kind kind;
  Range range{};                  ///< kNumber, kInteger
  std::string unit{};             ///< kNumber; "1" for a plain number
  std::vector<Choice> choices{};  ///< kChoice
  std::size_t min_count = 0;      ///< kArray, kMap, kText (characters)
  std::size_t max_count = std::numeric_limits<std::size_t>::max();
  std::vector<Type> inner{};  ///< kArray, kMap: the element; kOneOf: the alternatives
  std::vector<RecordPtr>
      records{};             ///< kRecord: one; kTagged: one for each value of the tag, which is its name
  std::string pattern{};     ///< kText: a regular expression that says in the JSON Schema what `check` says
  std::string tag{};         ///< kTagged: the key that says which record it is
  std::string expected{};    ///< words for messages; made from the rest when empty
  std::string definition{};  ///< name under "definitions" of the JSON Schema; in place when empty
  Check check{};

  /// The same with other words for "expected ...".
  Type expecting(std::string words) const;
  /// The same, written once in the JSON Schema under a name.
  Type defined_as(std::string name) const;
  /// The same with a pattern for the JSON Schema; a further rule must check it.
  Type matching(std::string pattern) const;
  /// The same with a further rule.
  Type checked(Check rule) const;
  /// What a message expects here: "a number in [0, 1] (m)".
  std::string words() const;
};

Type number(Range range, std::string unit);
Type integer(Range range);
Type boolean();
/// Any text with at least this many bytes.
Type text(std::size_t min_count = 0);
/// The name of a thing: not empty, at most 100 bytes, without "/" and control characters.
Type name();
Type choice(std::vector<Choice> choices);
Type array(Type element, std::size_t min_count = 0,
           std::size_t max_count = std::numeric_limits<std::size_t>::max());
/// [x, y, z].
Type vector3(const std::string& unit, Range range = unbounded());
/// An object whose keys are free names.
Type map(Type element);
Type record(Record fields);
/// An object whose key `tag` names the record, as {"type": "taper", ...}; the records do not list the tag
/// itself.
Type tagged(std::string tag, std::vector<Record> records);
/// One of several types. The JSON type of a value chooses among them, for objects also the keys it has; only
/// the chosen one's faults are shown.
Type one_of(std::vector<Type> alternatives);

/// A key of a record.
struct Field {
  std::string key;
  Type type;
  std::string description;
  bool required = false;
  /// The value of an absent key; null when absence has a meaning of its own, which the description tells.
  std::shared_ptr<const JsonValue> default_value{};
  std::string default_text{};  ///< the same as written
  std::string example{};       ///< JSON for the message about a missing key
};

/// Throws std::logic_error when `example` or `default_text` is not JSON.
Field required(std::string key, Type type, std::string description, std::string example = "");
Field optional(std::string key, Type type, std::string description, std::string default_text = "");

/// Keys of which a value may have only one, or must have one.
struct KeyGroup {
  std::vector<std::string> keys;
  bool at_least_one = false;
};

struct Record {
  std::string name;  ///< name under "definitions"; for a tagged record also the value of the tag
  std::string description;
  std::vector<Field> fields;
  std::vector<KeyGroup> exclusive{};

  /// Null when the record has no such key.
  const Field* find(const std::string& key) const;
};

/// The alternative of a kOneOf type that the keys of an object speak for: the one that knows most of them,
/// the first of equals; null when none knows any and there are several.
const Type* chosen_alternative(const Type& one_of, const JsonValue& object);

/// Keys that any object may have and nothing reads: comments "//" and extensions "x-...".
bool is_ignored_key(const std::string& key);

/// The JSON Schema (draft-07) of a scene whose root is `root`: every key with description, unit, default and
/// range.
std::string schema_json(const Record& root);

}  // namespace pliant::schema
