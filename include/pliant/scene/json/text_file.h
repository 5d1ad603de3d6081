// Reading a whole text file, with the faults of the file system named.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace pliant {

/// A file that cannot be read. what() is "path: reason", with the system's own words and the nearest name in
/// its folder.
class FileError : public std::runtime_error {
 public:
  enum class Reason { kMissing, kNotReadable, kTooLarge };

  FileError(Reason reason, const std::string& message) : std::runtime_error(message), reason_(reason) {}
  Reason reason() const { return reason_; }
  /// Exit code of the program for this fault: 3 for a missing input, 8 above the size limit, else 7.
  int exit_code() const { return reason_ == Reason::kMissing ? 3 : reason_ == Reason::kTooLarge ? 8 : 7; }

 private:
  Reason reason_;
};

/// The bytes of a file; "-" is standard input. A file larger than `most` bytes is refused, a regular one
/// before anything is read. Throws FileError.
std::string read_text_file(const std::string& path, std::size_t most);

}  // namespace pliant
