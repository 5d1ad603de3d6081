// Files that are whole or absent: written under a temporary name beside the target, closed with a check, then
// renamed. A reader sees the old file or the new one, never a part; a symbolic link of the target's name is
// replaced, not followed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace pliant {

/// Whether a file must reach the disk before it takes its name: yes survives a power cut, no is faster and
/// survives the end of the process.
enum class Durable { no, yes };

/// A file that is being written piece by piece. Every member throws std::system_error with path and reason
/// (of a full disk also the bytes needed and free); the target is then as it was, and the temporary file goes
/// away.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path target);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* bytes, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Closes the file and gives it the target's name.
  void become_target(Durable durable = Durable::no);

 private:
  std::filesystem::path target_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// Makes `path` hold exactly these bytes, replacing a file of that name.
void write_whole_file(const std::filesystem::path& path, const void* bytes, std::size_t size,
                      Durable durable = Durable::no);

}  // namespace pliant
