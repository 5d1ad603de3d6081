// The folder of a run: never shared by two runs, never mixed with files of another, never over anything a run
// did not write.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>

namespace pliant {

/// The folder would have to be overwritten, or is in use.
class OutputRefused : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class Existing {
  refuse,  ///< a folder that is not empty is refused
  force,   ///< the files of the run in it are removed, and nothing else
  resume,  ///< it must hold a run
};

/// Holds the folder: while it lives, a lock file with the number of the process keeps other runs out.
class RunFolder {
 public:
  /// Makes the folder and those above it. scene: the file that is read, which must not lie in a folder to be
  /// emptied; may be empty. Throws OutputRefused (not empty, a file, a symbolic link, in use, not a run's),
  /// std::system_error.
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

/// Makes a folder inside a run's folder. Throws OutputRefused when something else has its name (a symbolic
/// link counts).
void make_subfolder(const std::filesystem::path& folder);

}  // namespace pliant
