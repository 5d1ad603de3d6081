// A JSON value of a file. Each value and each key stores its place in the file; objects keep the order of
// their keys.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace pliant {

/// The place of a value: the text that contains it (0: the file; above 0: a --set option) and the byte
/// offset of its first character.
struct JsonPlace {
  std::uint32_t source = 0;
  std::uint32_t offset = 0;
};

/// An immutable JSON value. An accessor of a different kind throws std::bad_variant_access.
class JsonValue {
 public:
  enum class Kind { kNull, kBoolean, kNumber, kString, kArray, kObject };
  struct Number {
    double value;
    bool integer;  ///< whether the number is written without decimal point and exponent
  };
  struct Member;
  using Array = std::vector<JsonValue>;
  using Object = std::vector<Member>;  ///< in the order of the file; the comment key "//" may repeat
  using Content = std::variant<std::monostate, bool, Number, std::string, Array, Object>;

  JsonValue() = default;
  JsonValue(JsonPlace place, Content content) : content_(std::move(content)), place_(place) {}

  Kind kind() const { return static_cast<Kind>(content_.index()); }
  bool is_null() const { return kind() == Kind::kNull; }
  bool is_boolean() const { return kind() == Kind::kBoolean; }
  bool is_number() const { return kind() == Kind::kNumber; }
  bool is_string() const { return kind() == Kind::kString; }
  bool is_array() const { return kind() == Kind::kArray; }
  bool is_object() const { return kind() == Kind::kObject; }

  bool boolean() const { return std::get<bool>(content_); }
  double number() const { return std::get<Number>(content_).value; }
  bool is_integer_literal() const { return is_number() && std::get<Number>(content_).integer; }
  const std::string& string() const { return std::get<std::string>(content_); }
  const Array& array() const { return std::get<Array>(content_); }
  const Object& members() const { return std::get<Object>(content_); }

  /// Returns the value of a key of an object, or null if the object has no such key.
  const JsonValue* find(std::string_view key) const;

  JsonPlace place() const { return place_; }

 private:
  friend class JsonDocument;
  Content content_;
  JsonPlace place_;
};

struct JsonValue::Member {
  std::string key;
  JsonPlace key_place;
  JsonValue value;
};

inline const JsonValue* JsonValue::find(std::string_view key) const {
  for (const Member& member : members()) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

}  // namespace pliant
