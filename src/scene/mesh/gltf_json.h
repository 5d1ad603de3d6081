// Access to the JSON text of a glTF file. Errors name the file, the JSON pointer of the value, the value
// found and the value expected.
#pragma once

#include <string>

#include <pliant/scene/json/json_document.h>

#include "raw_mesh.h"

namespace pliant::gltf {

/// A value of the JSON text with its JSON pointer. A member that does not exist is null.
class Value {
 public:
  Value(const std::string& file, const JsonValue* json, std::string pointer)
      : file_(&file), json_(json), pointer_(std::move(pointer)) {}

  bool exists() const { return json_ != nullptr; }
  /// Returns a member of an object, or a null value if this value is absent. Throws std::invalid_argument if
  /// this value exists and is not an object.
  Value operator[](const std::string& key) const;
  /// Returns the number of elements of an array; 0 if there is no value.
  std::size_t size() const;
  /// Returns an element of an array. The index is below size().
  Value operator[](std::size_t index) const;
  /// Returns an integer from 0 to `max`; `absent` if there is no value.
  std::size_t integer(std::size_t max, std::size_t absent) const;
  /// Returns an integer from 0 to `max`; throws if there is no value.
  std::size_t integer(std::size_t max) const;
  double number() const;
  bool boolean() const;
  const std::string& text() const;
  /// Throws std::invalid_argument with the place of this value.
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const;

 private:
  const std::string* file_;
  const JsonValue* json_;
  std::string pointer_;
};

/// Parses the JSON text of a glTF file. Throws std::invalid_argument with the place of the first fault.
JsonDocument parse_json(const std::string& name, std::string text);

}  // namespace pliant::gltf
