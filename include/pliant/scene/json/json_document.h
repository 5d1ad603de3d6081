// A JSON file read strictly, with the place of every value: what is wrong with it as JSON is reported here,
// what is wrong with it as a scene by schema validation.
//
// Refused: syntax faults, comments outside of "//" keys, keys given twice (except "//"), numbers beyond
// double (1e400) or rounded to zero (1e-400), NUL or invalid UTF-8 in strings, nesting deeper than kMaxDepth,
// files larger than kMaxBytes or with more than kMaxValues values. A byte-order mark, CRLF and tabs are
// accepted.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/json_value.h>
#include <pliant/scene/json/text_file.h>

namespace pliant {

class JsonDocument {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  static constexpr std::size_t kMaxValues = 4'000'000;
  static constexpr int kMaxDepth = 64;

  /// Reads a file ("-" is standard input). Throws FileError when it cannot be read, SceneError when its
  /// syntax leaves no value to go on with; duplicate keys and the like are added to `faults`, and reading
  /// goes on.
  static JsonDocument read(const std::string& path, Diagnostics& faults);
  /// The same for a text, `name` standing for the file in messages.
  static JsonDocument parse(std::string name, std::string text, Diagnostics& faults);

  const JsonValue& root() const { return root_; }
  const std::string& name() const { return sources_[0].name; }
  /// The bytes of the file.
  const std::string& text() const { return sources_[0].text; }

  /// Replaces the value at a JSON pointer by the value written in `text`, or adds a key to an object or an
  /// element to an array ("/-" or the index after the last). Text that cannot be meant as JSON, arm or 2*t,
  /// is taken as a string. Faults (no such parent, bad value) are added; the document then stays as it was.
  /// References to values become invalid.
  void set(const std::string& pointer, const std::string& text, Diagnostics& faults);
  /// The same from one argument, "/pointer=value".
  void set(const std::string& assignment, Diagnostics& faults);

  /// The value at a JSON pointer; null when there is none.
  const JsonValue* at(std::string_view pointer) const;
  /// The JSON pointer of a value of this document (by its address).
  std::string pointer_to(const JsonValue& value) const;
  /// A value as it is written, shortened for a message; objects and long arrays are only named.
  std::string shown(const JsonValue& value) const;

  /// A fault at a value, at a key of an object, or inside a string at a byte of its decoded text.
  Diagnostic fault(const JsonValue& value, std::string message, Severity severity = Severity::kError) const;
  Diagnostic fault_at_key(const JsonValue& object, std::string_view key, std::string message,
                          Severity severity = Severity::kError) const;
  Diagnostic fault_in_string(const JsonValue& string, std::size_t byte, std::string message,
                             Severity severity = Severity::kError) const;
  /// A fault at a place, for those who know the pointer already.
  Diagnostic fault_at(JsonPlace place, std::string pointer, std::string message,
                      Severity severity = Severity::kError) const;
  /// The place of a byte of a string's decoded text.
  JsonPlace place_in_string(const JsonValue& string, std::size_t byte) const;

 private:
  struct Source {
    std::string name;
    std::string text;
    std::vector<std::uint32_t> lines;  ///< offset at which each line begins
  };
  static Source make_source(std::string name, std::string text);

  std::vector<Source> sources_;
  JsonValue root_;
};

/// Pointer plus one key or index, with ~ and / escaped.
std::string pointer_join(const std::string& pointer, std::string_view key);
std::string pointer_join(const std::string& pointer, std::size_t index);

}  // namespace pliant
