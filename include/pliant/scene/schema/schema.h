// A small language for the schema of a scene: records of keys with types, ranges, units, defaults and
// descriptions. Validation, reading and the JSON Schema are all derived from these records.
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

/// An interval of allowed numbers.
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

/// An allowed word of a choice and its meaning.
struct Choice {
  std::string word;
  std::string meaning;
};

/// Argument `byte` of ReportAt for a fault of the whole value.
inline constexpr std::size_t kWholeValue = static_cast<std::size_t>(-1);
/// Reports a fault at the checked value or at a value inside it; for a string, optionally at a byte of its
/// text.
using ReportAt = std::function<void(const JsonValue& where, const std::string& message, std::size_t byte)>;
/// A rule beyond types and ranges; called only for a value whose type, ranges and keys have no fault.
using Check = std::function<void(const JsonValue& value, const ReportAt& report)>;

/// The type of a value, made by the functions below. The comment of a member names the kinds that use it.
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
  std::string unit{};             ///< kNumber; "1" for a dimensionless number
  std::vector<Choice> choices{};  ///< kChoice
  std::size_t min_count = 0;      ///< kArray: elements; kText, kName: bytes
  std::size_t max_count = std::numeric_limits<std::size_t>::max();  ///< kArray: elements; kName: bytes
  std::vector<Type> inner{};  ///< kArray, kMap: the element; kOneOf: the alternatives
  /// kRecord: one record; kTagged: one record per value of the tag, named by that value.
  std::vector<RecordPtr> records{};
  std::string pattern{};     ///< kText: regular expression for the JSON Schema; `check` must enforce it
  std::string tag{};         ///< kTagged: the key whose value selects the record
  std::string expected{};    ///< text after "expected" in messages; derived from the type when empty
  std::string definition{};  ///< name under "definitions" of the JSON Schema; when empty, the type is inlined
  Check check{};

  /// Returns a copy with another text after "expected" in messages.
  Type expecting(std::string words) const;
  /// Returns a copy that the JSON Schema stores once, under this name.
  Type defined_as(std::string name) const;
  /// Returns a copy with a pattern for the JSON Schema; a rule added by checked() must enforce it.
  Type matching(std::string pattern) const;
  /// Returns a copy with an additional rule.
  Type checked(Check rule) const;
  /// Returns the text after "expected" in messages: "a number in [0, 1] (m)".
  std::string words() const;
};

Type number(Range range, std::string unit);
Type integer(Range range);
Type boolean();
/// A text with at least this many bytes.
Type text(std::size_t min_count = 0);
/// A name: 1 to 100 bytes, without "/" and control characters.
Type name();
Type choice(std::vector<Choice> choices);
Type array(Type element, std::size_t min_count = 0,
           std::size_t max_count = std::numeric_limits<std::size_t>::max());
/// [x, y, z].
Type vector3(const std::string& unit, Range range = unbounded());
/// An object whose keys are arbitrary names.
Type map(Type element);
Type record(Record fields);
/// An object whose key `tag` selects the record, as {"type": "taper", ...}. The records do not list the tag.
Type tagged(std::string tag, std::vector<Record> records);
/// One of several types. The JSON type of a value selects the alternative. Among several alternatives for
/// objects, the keys of the object decide (chosen_alternative()). Among several alternatives for arrays, the
/// alternative with the fewest faults is selected. Only faults of the selected alternative are reported.
Type one_of(std::vector<Type> alternatives);

/// A key of a record.
struct Field {
  std::string key;
  Type type;
  std::string description;
  bool required = false;
  /// The value of an absent key. It is null if an absent key has a meaning of its own, which the description
  /// states.
  std::shared_ptr<const JsonValue> default_value{};
  std::string default_text{};  ///< the default value as JSON text
  std::string example{};       ///< JSON text for the message about a missing key
};

/// Declare a required or an optional key. Both functions throw std::logic_error if `example` or
/// `default_text` is not JSON.
Field required(std::string key, Type type, std::string description, std::string example = "");
Field optional(std::string key, Type type, std::string description, std::string default_text = "");

/// Keys that exclude each other: an object may have at most one of them, or must have exactly one.
struct KeyGroup {
  std::vector<std::string> keys;
  bool at_least_one = false;
};

struct Record {
  std::string
      name;  ///< name under "definitions" of the JSON Schema; for a tagged record, the value of the tag
  std::string description;
  std::vector<Field> fields;
  std::vector<KeyGroup> exclusive{};

  /// Returns the field with this key, or null if the record has no such key.
  const Field* find(const std::string& key) const;
};

/// Returns the alternative of a kOneOf type that declares most keys of an object. A required key outweighs
/// all optional keys, and among equal alternatives the first is returned. If only one alternative accepts
/// objects, returns this alternative. Returns null if no alternative accepts objects, or if several
/// alternatives accept objects and none of them declares a key of this object.
const Type* chosen_alternative(const Type& one_of, const JsonValue& object);

/// Returns whether a key is ignored in every object: comments "//" and extensions "x-...".
bool is_ignored_key(const std::string& key);

/// Returns the JSON Schema (draft-07) of a scene with this root record: each key with its description, unit,
/// range, and default or example.
std::string schema_json(const Record& root);

}  // namespace pliant::schema
