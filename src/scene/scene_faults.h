// What a scene asks for and cannot have, found while a validated document is read: told at the value, as
//   value; what is wrong or what was expected; nearest name
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

  /// Faults so far, those of the validation included.
  std::size_t errors() const { return diagnostics_.errors(); }

  /// A fault at a value, which is shown before the message.
  void value(const JsonValue& at, const std::string& message);
  /// A warning likewise.
  void warn(const JsonValue& at, const std::string& message);
  /// A fault at a value that is named by its place alone: an object, a long array.
  void place(const JsonValue& at, const std::string& message);
  /// A fault at a key of an object.
  void key(const JsonValue& object, const std::string& key, const std::string& message);

  /// "name given twice": `again` has the name that the value `first` has already.
  void twice(const JsonValue& first, const JsonValue& again);
  /// A name that is none of `names`, which are called `kind` ("part").
  void unknown(const JsonValue& name, const std::string& kind, const std::vector<std::string>& names);

 private:
  void add(const JsonValue& at, std::string message, Severity severity);

  const JsonDocument& document_;
  Diagnostics& diagnostics_;
};

/// A computed number with the digits that a reader wants.
std::string brief(double x);

/// "; did you mean "NAME"?", or where no name is near "; expected one of "A", "B"".
std::string name_hint(std::string_view word, const std::vector<std::string>& names);

}  // namespace pliant
