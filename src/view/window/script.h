// Synthetic input: a text file whose lines are inputs of a user and pauses.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "viewer.h"

namespace pliant {

/// The README of include/pliant/view lists the lines.
class Script {
 public:
  /// Throws std::invalid_argument if the file cannot be read.
  explicit Script(const std::filesystem::path& file);

  /// Performs lines up to the next line that waits for pictures. The window calls this function before each
  /// picture. Returns false at the end of the file. out: output of `report` and `part`. Throws
  /// std::invalid_argument, which names the line, for an unknown line.
  bool perform(Viewer& viewer, std::ostream& out);

 private:
  bool perform_line(const std::string& line, Viewer& viewer, std::ostream& out);
  void move_over(const std::string& part, Viewer& viewer) const;
  [[noreturn]] void fail(const std::string& reason) const;

  std::filesystem::path file_;
  std::vector<std::string> lines_;
  std::size_t next_ = 0;
  int pictures_ = 0;   // number of pictures to be drawn before the next line
  double until_ = -1;  // simulated time before which no line is performed, s
};

}  // namespace pliant
