// Faults of a scene. Each fault names its place, the value found and the value expected. All faults of a file
// are collected and printed together. Each fault is one line:
//   file:line:column: error: /json/pointer: value; expected ...; did you mean ...?
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

enum class Severity { kError, kWarning };

struct Diagnostic {
  std::string file;     ///< name of the file, or "--set /pointer" for a value from the command line
  int line = 0;         ///< counted from 1; 0 for a value from --set
  int column = 0;       ///< counted from 1, in characters (not bytes); a tab is one character
  std::string pointer;  ///< JSON pointer (RFC 6901) of the value; empty for the whole file
  std::string message;
  Severity severity = Severity::kError;
};

/// Returns the diagnostic as one line without a line break. The texts are escaped as by escaped(), so that a
/// file cannot control the terminal.
std::string to_string(const Diagnostic& diagnostic);

/// Returns the text with escapes in place of all characters that must not reach a terminal: control
/// characters, such as line feed and escape, line separators, byte-order marks, characters that change the
/// writing direction, and bytes that are not UTF-8.
std::string escaped(std::string_view text);

class Diagnostics {
 public:
  static constexpr std::size_t kMaxPrinted = 20;
  /// Further faults are counted but not stored.
  static constexpr std::size_t kMaxStored = 1000;

  void add(Diagnostic diagnostic);
  /// Returns whether the storage is full; a reader may then stop searching for faults.
  bool full() const { return stored_.size() >= kMaxStored; }

  std::size_t errors() const { return errors_; }
  std::size_t warnings() const { return warnings_; }
  /// Returns the stored faults, sorted by file (in order of first appearance), line and column.
  std::vector<Diagnostic> sorted() const;

  /// Returns the sorted faults as lines, at most `max_lines` of them, then "... and N more". Empty if there
  /// are no faults.
  std::string text(std::size_t max_lines = kMaxPrinted) const;
  /// Returns all stored faults as JSON: {"errors": n, "warnings": n, "diagnostics": [{"file", "line",
  /// "column", "pointer", "severity", "message"}, ...]}.
  std::string json() const;
  /// Throws SceneError if there is an error; warnings alone do not throw.
  void throw_if_errors() const;

 private:
  std::vector<Diagnostic> stored_;
  std::size_t errors_ = 0, warnings_ = 0;
};

/// Thrown for a scene that cannot be read; what() is the text of its diagnostics.
class SceneError : public std::runtime_error {
 public:
  explicit SceneError(Diagnostics diagnostics);
  const Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics diagnostics_;
};

}  // namespace pliant
