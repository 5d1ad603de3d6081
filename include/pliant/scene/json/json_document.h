// A JSON file, read strictly, with the place of every value. This class reports faults of JSON syntax; schema
// validation (pliant/scene/validate.h) reports faults of the scene.
//
// Refused: syntax faults, comments outside of "//" keys, keys given twice (except "//"), numbers that
// overflow a double (1e400) or round to zero (1e-400), NUL or invalid UTF-8 in strings, nesting deeper than
// kMaxDepth, files larger than kMaxBytes or with more than kMaxValues values. A byte-order mark, CRLF and
// tabs are accepted.
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

  /// Reads a file ("-" is standard input). Throws FileError if it cannot be read or has more than kMaxBytes,
  /// and SceneError after a syntax fault, a number that overflows, or an excess over kMaxDepth or kMaxValues.
  /// Faults that leave the syntax intact (duplicate keys, numbers that round to zero, the character U+0000)
  /// are added to `faults`, and reading continues.
  static JsonDocument read(const std::string& path, Diagnostics& faults);
  /// Reads a text; `name` replaces the file name in messages. Throws and reports faults as read() does.
  static JsonDocument parse(std::string name, std::string text, Diagnostics& faults);

  const JsonValue& root() const { return root_; }
  const std::string& name() const { return sources_[0].name; }
  /// The bytes of the file.
  const std::string& text() const { return sources_[0].text; }

  /// Replaces the value at a JSON pointer by the JSON value in `text`. If the pointer has no value, adds a
  /// key to an object or an element to an array ("/-" or the index after the last one). Text that is clearly
  /// not JSON (arm, 2*t) becomes a string. Faults (the parent does not exist, the text is bad JSON) are added
  /// to `faults`; the document is then unchanged. References to values become invalid.
  void set(const std::string& pointer, const std::string& text, Diagnostics& faults);
  /// Applies one assignment "/pointer=value".
  void set(const std::string& assignment, Diagnostics& faults);

  /// Returns the value at a JSON pointer, or null if there is none.
  const JsonValue* at(std::string_view pointer) const;
  /// Returns the JSON pointer of the value of this document that has the address of `value`. Returns an empty
  /// text for the root, and for a value that is not in this document.
  std::string pointer_to(const JsonValue& value) const;
  /// Returns a value as it is written in the file, shortened for a message. Objects, long arrays and arrays
  /// with an object are only described.
  std::string shown(const JsonValue& value) const;

  /// Return a fault at a value, at a key of an object (at the object itself if it has no such key), or inside
  /// a string at a byte of its decoded text.
  Diagnostic fault(const JsonValue& value, std::string message, Severity severity = Severity::kError) const;
  Diagnostic fault_at_key(const JsonValue& object, std::string_view key, std::string message,
                          Severity severity = Severity::kError) const;
  Diagnostic fault_in_string(const JsonValue& string, std::size_t byte, std::string message,
                             Severity severity = Severity::kError) const;
  /// Returns a fault at a place whose pointer the caller knows.
  Diagnostic fault_at(JsonPlace place, std::string pointer, std::string message,
                      Severity severity = Severity::kError) const;
  /// Returns the place in the file of a byte of the decoded text of a string.
  JsonPlace place_in_string(const JsonValue& string, std::size_t byte) const;

 private:
  struct Source {
    std::string name;
    std::string text;
    std::vector<std::uint32_t> lines;  ///< byte offset of the start of each line
  };
  static Source make_source(std::string name, std::string text);

  std::vector<Source> sources_;
  JsonValue root_;
};

/// Returns a pointer extended by one key or index; ~ and / in the key are escaped (RFC 6901).
std::string pointer_join(const std::string& pointer, std::string_view key);
std::string pointer_join(const std::string& pointer, std::size_t index);

}  // namespace pliant
