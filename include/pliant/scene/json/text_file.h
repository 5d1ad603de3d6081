// Reads a whole text file. The messages of errors explain the fault of the file system.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace pliant {

/// Thrown for a file that cannot be read. what() begins with the path. For a file that is too large, the
/// limit follows. Otherwise the message of the operating system follows, and for a missing file the nearest
/// name in its folder.
class FileError : public std::runtime_error {
 public:
  enum class Reason { kMissing, kNotReadable, kTooLarge };

  FileError(Reason reason, const std::string& message) : std::runtime_error(message), reason_(reason) {}
  Reason reason() const { return reason_; }
  /// Exit code of the program for this fault: 3 for a missing input, 8 for a file above the size limit,
  /// else 7.
  int exit_code() const { return reason_ == Reason::kMissing ? 3 : reason_ == Reason::kTooLarge ? 8 : 7; }

 private:
  Reason reason_;
};

/// Returns the bytes of a file; "-" is standard input. A file larger than `max_bytes` is refused; the size of
/// a regular file is checked before reading. Throws FileError.
std::string read_text_file(const std::string& path, std::size_t max_bytes);

}  // namespace pliant
