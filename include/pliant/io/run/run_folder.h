// The folder of a run. Two runs never share a folder, and a run never overwrites files that a run did not
// write.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

namespace pliant {

/// Thrown if files would have to be overwritten or the folder is in use.
class OutputRefused : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class Existing {
  refuse,  ///< a folder that contains a run or other files is refused
  force,   ///< a new run replaces the run in the folder, but no other files
  resume,  ///< the run in the folder continues; if no run has begun in it, a new run begins
};

/// A locked folder. During its lifetime a lock file with the process number excludes other runs.
///
/// A run begins in one step. A new run writes its first files into a folder of its own, new_run.part-PID-N,
/// inside the folder of the run. When all these files are whole, the folder is renamed to new_run.whole: from
/// now on the folder contains the new run. Then the files of the old run are removed, new_run.whole is
/// renamed to new_run.moving, its files are moved to the folder of the run, and it is removed. If the process
/// is killed in between, the next one that locks the folder completes these steps. If it is killed before the
/// first of them, the old run is as it was, and the next process removes new_run.part-PID-N.
class RunFolder {
 public:
  /// Creates the folder and its parents, and locks it. Removes unfinished files of killed processes. scene:
  /// path of the scene file, which must not be in a folder whose files will be replaced; may be empty. Throws
  /// OutputRefused (not empty, a file, a symbolic link, in use, not a folder of a run), std::system_error.
  RunFolder(std::filesystem::path folder, Existing existing, const std::filesystem::path& scene = {});
  /// Removes the folder of a new run that has not begun, and the folder of the run if it was created and is
  /// empty.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path operator/(const char* name) const { return folder_ / name; }
  /// Returns whether the folder contains a run that has begun.
  bool has_run() const;
  /// Returns what was found and mended in the folder, as a text for the user; may be empty.
  const std::string& note() const { return note_; }

  /// Creates an empty folder for the files of a new run and returns its path.
  std::filesystem::path new_run();
  /// Replaces the run in the folder by the new run, whose files must be complete.
  void begin_new_run();

 private:
  class Lock;

  bool refuse_unless_allowed(Existing existing, const std::filesystem::path& scene) const;
  void remove_unfinished_files();
  void complete_beginning();
  void remove_old_run();

  std::filesystem::path folder_, new_run_;
  std::string note_;
  bool created_ = false;
  std::unique_ptr<Lock> lock_;
};

/// Returns the path of run.json of the run in a folder, also if the process was killed while the files of
/// this run were moved to the folder. Returns an empty path if the folder exists and no run has begun in it.
/// Does not lock the folder.
std::filesystem::path find_run_file(const std::filesystem::path& folder);

/// Creates a folder inside the folder of a run. Throws OutputRefused if a file or a symbolic link has its
/// name.
void make_subfolder(const std::filesystem::path& folder);

}  // namespace pliant
