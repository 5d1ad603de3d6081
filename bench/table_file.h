// A CSV file of a bench, written row by row; none without a path.
#pragma once

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

namespace pliant::bench {

class TableFile {
 public:
  /// head: comments and the line of column names. Throws std::runtime_error when it cannot be written.
  TableFile(const std::string& path, const std::string& head) {
    if (path.empty()) return;
    file_.open(path);
    if (!file_) throw std::runtime_error("cannot write " + path);
    file_ << head << std::flush;
  }
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
