// Faults of a scene: each says where, what was found, what was expected. All faults of a file are collected
// and shown together, as  file:line:column: error: /json/pointer: value; what was expected; nearest name
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
  int line = 0;         ///< from 1; 0 when there is none
  int column = 0;       ///< from 1, in characters (not bytes; a tab is one)
  std::string pointer;  ///< JSON pointer (RFC 6901) of the value; empty for the whole file
  std::string message;
  Severity severity = Severity::kError;
};

/// One line without its end. Control characters, bytes that are not UTF-8 and characters that turn the
/// writing direction are escaped, so that a file cannot steer the terminal.
std::string to_string(const Diagnostic& diagnostic);

/// Text with everything escaped that is not to reach a terminal: \n, \x1b, \u{202e}.
std::string escaped(std::string_view text);

class Diagnostics {
 public:
  static constexpr std::size_t kMaxPrinted = 20;
  /// Faults beyond these are only counted.
  static constexpr std::size_t kMaxStored = 1000;

  void add(Diagnostic diagnostic);
  /// So many errors are stored that looking for more has no use.
  bool full() const { return stored_.size() >= kMaxStored; }

  std::size_t errors() const { return errors_; }
  std::size_t warnings() const { return warnings_; }
  /// In the order of the file: by file name in order of appearance, line, column.
  std::vector<Diagnostic> sorted() const;

  /// Lines in the order of the file, at most `most` of them, then "... and N more". Empty without faults.
  std::string text(std::size_t most = kMaxPrinted) const;
  /// For machines: {"errors": n, "warnings": n, "diagnostics": [{"file", "line", "column", "pointer",
  /// "severity", "message"}, ...]} with all stored faults.
  std::string json() const;
  /// Throws SceneError when there is an error; warnings alone pass.
  void throw_if_errors() const;

 private:
  std::vector<Diagnostic> stored_;
  std::size_t errors_ = 0, warnings_ = 0;
};

/// A scene that cannot be read; what() is the text of its diagnostics.
class SceneError : public std::runtime_error {
 public:
  explicit SceneError(Diagnostics diagnostics);
  const Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics diagnostics_;
};

}  // namespace pliant
