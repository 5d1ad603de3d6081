// Faults found while a validated document is read, for example unknown part names. Each fault is reported at
// its value, as
//   value; the fault; expected ...; nearest name
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
  /// Adds a warning at a value; the message begins with the value.
  void warn(const JsonValue& at, const std::string& message);
  /// Adds an error at the place of a value that the message does not show: an object, a long array.
  void place(const JsonValue& at, const std::string& message);
  /// Adds an error at a key of an object.
  void key(const JsonValue& object, const std::string& key, const std::string& message);

  /// Adds the error "name given twice" at `again`, a name that the value `first` also has.
  void twice(const JsonValue& first, const JsonValue& again);
  /// Adds the error of a name that is not among `names`. kind: kind of thing that has such a name, for
  /// example "part".
  void unknown(const JsonValue& name, const std::string& kind, const std::vector<std::string>& names);

 private:
  void add(const JsonValue& at, std::string message, Severity severity);

  const JsonDocument& document_;
  Diagnostics& diagnostics_;
};

/// Returns a computed number with 4 significant digits.
std::string brief(double x);

/// Returns "; did you mean "NAME"?" for the nearest name, or "; expected one of "A", "B"" with the first 32
/// names if no name is near.
std::string name_hint(std::string_view word, const std::vector<std::string>& names);

}  // namespace pliant
