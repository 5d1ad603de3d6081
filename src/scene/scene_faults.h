// Faults found while a validated document is read, for example unknown part names. A message has the form
//   value; fault; expected ...; nearest name
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/json_document.h>

namespace pliant {

class SceneFaults {
 public:
  SceneFaults(const JsonDocument& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  /// Number of errors so far, including those of the validation.
  std::size_t errors() const { return diagnostics_.errors(); }

  /// Adds an error at a value; the message begins with the value.
  void value(const JsonValue& at, const std::string& message);
  /// Adds an error at a byte of the decoded text of a string; the message begins with the string.
  void in_string(const JsonValue& string, std::size_t byte, const std::string& message);
  /// Adds a warning at a value; the message begins with the value.
  void warn(const JsonValue& at, const std::string& message);
  /// Adds an error at a value; the message does not contain the value. For objects and long arrays.
  void place(const JsonValue& at, const std::string& message);
  /// Adds an error at a key of an object; the message does not contain the value.
  void key(const JsonValue& object, const std::string& key, const std::string& message);

  /// Adds the error "name given twice" at the name `again`. first: the first value with this name; the
  /// message contains its line and column, or its --set option.
  void twice(const JsonValue& first, const JsonValue& again);
  /// Adds the error that a name is not one of `names`, with a name_hint(). kind: noun for the named thing,
  /// for example "part".
  void unknown(const JsonValue& name, const std::string& kind, const std::vector<std::string>& names);

 private:
  void add(const JsonValue& at, std::string message, Severity severity);

  const JsonDocument& document_;
  Diagnostics& diagnostics_;
};

/// Returns a number as text, rounded to 4 significant digits.
std::string brief(double x);

/// Returns "; did you mean "NAME"?" for the name nearest to a word. If no name is near, returns "; expected
/// one of "A", "B"" with the first 32 names, or an empty text if `names` is empty.
std::string name_hint(std::string_view word, const std::vector<std::string>& names);

}  // namespace pliant
