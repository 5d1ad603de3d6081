// Files that are whole or absent. A file is written under a temporary name in the folder of the target,
// closed, and renamed if closing reports no error. A reader sees either the old or the new file, never a
// part. A symbolic link with the name of the target is replaced, not followed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace pliant {

/// Whether a file must reach the disk before it is renamed. With yes, the file survives a power cut. With
/// Durable::no, writing is faster, and the file survives only a crash of the process.
enum class Durable { no, yes };

/// Waits until the names of the files in a folder are on the disk. Without this call, a power cut may bring
/// back the old content of a replaced file. Throws std::system_error.
void sync_folder(const std::filesystem::path& folder);

/// A file that is written piece by piece. All members throw std::system_error with path and reason (for a
/// full disk also the needed and free bytes). If a member throws, the target is unchanged, and the destructor
/// removes the temporary file.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path target);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(const void* bytes, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Closes the file and renames it to the target.
  void become_target(Durable durable = Durable::no);

 private:
  std::filesystem::path target_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// Writes a file with exactly these bytes; an existing file is replaced.
void write_whole_file(const std::filesystem::path& path, const void* bytes, std::size_t size,
                      Durable durable = Durable::no);

/// Returns the bytes of a file. Throws std::system_error.
std::string read_whole_file(const std::filesystem::path& path);

}  // namespace pliant
