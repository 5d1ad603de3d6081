// A JSON value as it stands in a file: each value and each key knows its place, objects keep the order of the
// file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace pliant {

/// Where a value begins: which text of the document (0 the file, else a --set option), and at which byte of
/// it.
struct JsonPlace {
  std::uint32_t source = 0;
  std::uint32_t offset = 0;
};

/// An immutable value. Asking for another type than it has throws std::bad_variant_access.
class JsonValue {
 public:
  enum class Kind { kNull, kBoolean, kNumber, kString, kArray, kObject };
  struct Number {
    double value;
    bool integer;  ///< written without point and exponent
  };
  struct Member;
  using Array = std::vector<JsonValue>;
  using Object = std::vector<Member>;  ///< in file order; keys that are comments may repeat
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

  /// The value of a key of an object; null when it has no such key.
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
