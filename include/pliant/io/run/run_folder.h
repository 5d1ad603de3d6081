// The folder of a run. Two runs never share a folder, and a run never overwrites files that a run did not
// write.
#pragma once

#include <filesystem>
#include <functional>
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
/// A folder that does not exist is prepared as NAME.part-PID-N, with the lock and the options of the run, and
/// then renamed: a folder of a run always contains the options, so that a killed run can begin again.
///
/// A run begins in one step. Its first files are written in new_run.part-PID-N inside the folder. When all
/// these files are whole, this inner folder is renamed to new_run.whole: from now on the folder contains the
/// new run. Then the files of the old run are removed, new_run.whole is renamed to new_run.moving, its files
/// are moved to the folder of the run, and new_run.moving is removed. If the process is killed during these
/// steps, the next process that locks the folder completes them. If the process is killed before
/// new_run.whole exists, an old run is unchanged, and the next process removes the unfinished inner folder.
class RunFolder {
 public:
  /// Writes the options of a new run to a file.
  using WriteOptions = std::function<void(const std::filesystem::path&)>;

  /// Creates the folder and its parents, if they do not exist, and locks it. Removes unfinished files of
  /// killed processes. scene: path of the scene file, which must not be in a folder whose files will be
  /// replaced; may be empty. write_options: called if a new run begins; may be empty. Throws OutputRefused
  /// (not empty, a file, a symbolic link, in use, not a folder of a run), std::system_error, and what
  /// write_options throws.
  RunFolder(std::filesystem::path folder, Existing existing, const std::filesystem::path& scene = {},
            const WriteOptions& write_options = {});
  /// Removes the files of a new run that has not begun, except its options if there is no old run.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path operator/(const char* name) const { return folder_ / name; }
  /// Returns whether the folder contains a run that has begun.
  bool has_run() const;
  /// Returns a note about the files that this object repaired or removed; empty if there are none.
  const std::string& note() const { return note_; }

  /// Creates an empty folder for the files of a new run and returns its path.
  std::filesystem::path new_run();
  /// Replaces the run in the folder by the new run, whose files must be complete.
  void begin_new_run();

 private:
  class Lock;

  bool refuse_unless_allowed(Existing existing, const std::filesystem::path& scene) const;
  std::filesystem::path create_locked(const std::filesystem::path& folder);
  void create(const WriteOptions& write_options);
  void remove_unfinished_files();
  void complete_beginning();
  void remove_old_run();

  std::filesystem::path folder_, new_run_;
  std::string note_;
  std::unique_ptr<Lock> lock_;
};

/// Returns the path of run.json of the run in a folder, also if the process was killed while the files of
/// this run were moved to the folder. If no run has begun in the folder, returns the path of the options with
/// which a run was to begin, or an empty path. If the folder does not exist, returns a path that does not
/// exist either. Does not lock the folder.
std::filesystem::path find_run_file(const std::filesystem::path& folder);

/// Creates a folder inside the folder of a run. Throws OutputRefused if a file or a symbolic link has its
/// name.
void make_subfolder(const std::filesystem::path& folder);

}  // namespace pliant
