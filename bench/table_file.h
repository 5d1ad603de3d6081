// A CSV file that a benchmark writes row by row, and a reader for it. Without a path no file is written.
#pragma once

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pliant::bench {

/// Returns the cells of the rows of a CSV file that starts with `head`; returns no rows if the file does not
/// exist. Throws std::runtime_error if the file starts differently.
inline std::vector<std::vector<std::string>> read_rows(const std::string& path, const std::string& head) {
  std::ifstream file(path);
  std::string columns(head.size(), '\0'), line;
  std::vector<std::vector<std::string>> rows;
  if (!file) return rows;
  if (!file.read(columns.data(), static_cast<std::streamsize>(head.size())) || columns != head)
    throw std::runtime_error(path + ": expected a file that starts with " + head);
  while (std::getline(file, line)) {
    std::vector<std::string>& row = rows.emplace_back(1);
    for (const char c : line)
      if (c == ',')
        row.emplace_back();
      else
        row.back() += c;
  }
  return rows;
}

class TableFile {
 public:
  /// head: comment lines and the line of column names. Throws std::runtime_error if the file cannot be
  /// written.
  TableFile(const std::string& path, const std::string& head) {
    if (path.empty()) return;
    file_.open(path);
    if (!file_) throw std::runtime_error("cannot write " + path);
    file_ << head << std::flush;
  }
  /// Writes a row of cells.
  void row(const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) file_ << (i > 0 ? "," : "") << cells[i];
    file_ << '\n' << std::flush;
  }
  /// Writes the text that std::printf would print, at most 511 characters. The format contains the line
  /// break.
  template <class... Args>
  void row(const char* format, Args... args) {
    char line[512];
    std::snprintf(line, sizeof line, format, args...);
    file_ << line << std::flush;
  }

 private:
  std::ofstream file_;
};

}  // namespace pliant::bench
