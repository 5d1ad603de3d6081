// The folder of a run. Two runs never share a folder, and a run never overwrites files that a run did not
// write.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>

namespace pliant {

/// Thrown if files would have to be overwritten or the folder is in use.
class OutputRefused : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class Existing {
  refuse,  ///< a folder that is not empty is refused
  force,   ///< the files of the run in it are removed, but no other files
  resume,  ///< the folder must contain a run
};

/// A locked folder. During its lifetime a lock file with the process number excludes other runs.
class RunFolder {
 public:
  /// Creates the folder and its parents, and locks it. scene: path of the scene file, which must not be in a
  /// folder whose files are removed; may be empty. Throws OutputRefused (not empty, a file, a symbolic link,
  /// in use, not a folder of a run), std::system_error.
  RunFolder(std::filesystem::path folder, Existing existing, const std::filesystem::path& scene = {});
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path operator/(const char* name) const { return folder_ / name; }

 private:
  class Lock;

  std::filesystem::path folder_;
  std::unique_ptr<Lock> lock_;
};

/// Creates a folder inside the folder of a run. Throws OutputRefused if a file or a symbolic link has its
/// name.
void make_subfolder(const std::filesystem::path& folder);

}  // namespace pliant
