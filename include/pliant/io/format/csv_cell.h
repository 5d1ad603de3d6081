// Text as a cell of a CSV file.
#pragma once

#include <string>

namespace pliant {

/// Returns a text as a cell of a CSV file, quoted if it contains a comma, a quote or a line break.
inline std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace pliant
