#include <pliant/io/run/run_folder.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <pliant/io/file_fault.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/retry.h>
#include <pliant/io/run/run_files.h>

namespace fs = std::filesystem;

namespace pliant {
namespace {

bool exists_at_all(const fs::path& path) {
  return fs::symlink_status(path).type() != fs::file_type::not_found;
}

/// Returns the entries of a folder. Opens the folder again if a signal interrupts the call.
fs::directory_iterator entries_of(const fs::path& folder) {
  for (;;) {
    std::error_code error;
    fs::directory_iterator entries(folder, error);
    if (!error) return entries;
    if (error != std::errc::interrupted) throw fs::filesystem_error("cannot read folder", folder, error);
  }
}

/// Returns the paths of the files in a folder, and in its folders of meshes and of frames, relative to the
/// folder.
std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const char* inner : {"", kMeshFolder, kFrameFolder}) {
    if (!fs::is_directory(fs::symlink_status(folder / inner))) continue;
    for (const fs::directory_entry& entry : entries_of(folder / inner))
      if (entry.is_symlink() || !entry.is_directory()) files.push_back(inner / entry.path().filename());
  }
  return files;
}

bool is_in(const fs::path& file, const fs::path& folder) {
  const fs::path inner = fs::weakly_canonical(file), outer = fs::weakly_canonical(folder);
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

/// Returns whether a name is the temporary name of an unfinished file or folder of a run.
bool is_unfinished(const fs::path& name) {
  const std::string text = name.string(), finished = finished_name(text);
  return finished != text && (finished == kNewRun || is_run_file(finished));
}

/// Returns whether a file with this name may remain in the folder of a run that is killed before it has
/// begun.
bool is_leftover(const fs::path& name) {
  return name == kLockFile || name == kNewRunFile || is_unfinished(name);
}

bool process_exists(int process) {
  return ::kill(process, 0) == 0 || errno != ESRCH;
}

/// Returns the path of run.json of the run that has begun in a folder; empty if there is none.
fs::path begun_run_file(const fs::path& folder) {
  for (const char* place : {kWholeNewRun, kMovingNewRun, "."}) {
    const fs::path file = (folder / place / kRunFile).lexically_normal();
    if (exists_at_all(file)) return file;
  }
  return {};
}

/// Creates a folder with the temporary name "NAME.part-PID-N" and returns its path. first: the smallest N.
fs::path create_unfinished(const fs::path& name, int first = 0) {
  for (int number = first;; ++number) {
    const fs::path path =
        name.string() + ".part-" + std::to_string(::getpid()) + "-" + std::to_string(number);
    if (fs::create_directory(path)) return path;
  }
}

/// Locks a file for as long as the object exists, if no other process has locked it. more_flags: additional
/// flags for open(), for example O_CREAT.
class TriedLock {
 public:
  explicit TriedLock(const fs::path& file, int more_flags = 0)
      : descriptor_(
            retry([&] { return ::open(file.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC | more_flags, 0666); })),
        locked_(descriptor_ >= 0 && retry([&] { return ::flock(descriptor_, LOCK_EX | LOCK_NB); }) == 0) {}
  ~TriedLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  TriedLock(const TriedLock&) = delete;
  TriedLock& operator=(const TriedLock&) = delete;

  bool locked() const { return locked_; }

 private:
  int descriptor_;
  bool locked_;
};

/// Returns whether a folder contains only files that remain if a run is killed before it has begun.
bool has_only_leftovers(const fs::path& folder) {
  const fs::directory_iterator first = entries_of(folder), end;
  return std::all_of(first, end,
                     [](const fs::directory_entry& inner) { return is_leftover(inner.path().filename()); });
}

/// Removes the folder of a new run that was killed before it began. The lock of the folder decides whether
/// its run is alive, because process numbers are used again, and the process may be on another machine. A
/// missing lock file is created: another process was killed while it removed the folder.
void remove_if_abandoned(const fs::path& folder) {
  if (fs::is_empty(folder)) {  // no lock yet: the process was killed, or is about to make the lock
    ::rmdir(folder.c_str());
    return;
  }
  if (!has_only_leftovers(folder)) return;
  const TriedLock lock(folder / kLockFile, O_CREAT);
  if (lock.locked() && has_only_leftovers(folder)) fs::remove_all(folder);
}

/// Removes the folders "NAME.part-PID-N" of new runs that were killed. folder: path of NAME. A folder that
/// cannot be read or removed does not prevent a run.
void remove_unfinished_folders(const fs::path& folder) {
  const fs::path parent = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  std::vector<fs::path> unfinished;
  try {
    for (const fs::directory_entry& entry : entries_of(parent)) {
      const std::string name = entry.path().filename().string();
      if (writing_process(name) >= 0 && finished_name(name) == folder.filename() &&
          fs::is_directory(entry.symlink_status()))
        unfinished.push_back(entry.path());
    }
  } catch (const fs::filesystem_error&) {
    return;
  }
  for (const fs::path& path : unfinished) {
    try {
      remove_if_abandoned(path);
    } catch (const fs::filesystem_error&) {
      // Another process may have removed the folder.
    }
  }
}

}  // namespace

// The lock file, locked by flock: the system releases the lock whenever the process ends.
class RunFolder::Lock {
 public:
  explicit Lock(const fs::path& folder) : path_(folder / kLockFile) {
    for (;;) {
      descriptor_ =
          retry([&] { return ::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666); });
      if (descriptor_ < 0) throw_file_fault(errno, "write", path_);
      if (retry([&] { return ::flock(descriptor_, LOCK_EX | LOCK_NB); }) != 0) refuse(errno, folder);
      // If the previous owner has just removed the file, this lock is on a file without a name. In this case
      // the loop tries again.
      struct stat locked {
      }, named{};
      if (::fstat(descriptor_, &locked) == 0 && ::stat(path_.c_str(), &named) == 0 &&
          locked.st_ino == named.st_ino && locked.st_dev == named.st_dev)
        break;
      ::close(descriptor_);
    }
    const std::string owner = std::to_string(::getpid());
    if (retry([&] { return ::ftruncate(descriptor_, 0); }) != 0 ||
        retry([&] { return ::pwrite(descriptor_, owner.data(), owner.size(), 0); }) < 0) {
      const int error = errno;
      ::unlink(path_.c_str());
      ::close(descriptor_);
      throw_file_fault(error, "write", path_, owner.size());
    }
  }
  /// Sets the path of the lock file after its folder has been renamed.
  void moved_to(const fs::path& folder) { path_ = folder / kLockFile; }
  ~Lock() {
    ::unlink(path_.c_str());
    ::close(descriptor_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  /// Throws the fault of a lock that another process has or that the file system refuses.
  [[noreturn]] void refuse(int error, const fs::path& folder) {
    if (error == EWOULDBLOCK) {
      char owner[32] = "";
      const ssize_t length = retry([&] { return ::pread(descriptor_, owner, sizeof owner - 1, 0); });
      ::close(descriptor_);
      throw OutputRefused("the output folder " + folder.string() + " is in use by another run (process " +
                          (length > 0 ? std::string(owner, static_cast<std::size_t>(length)) : "unknown") +
                          ")");
    }
    ::close(descriptor_);
    const bool no_locks = error == ENOLCK || error == EOPNOTSUPP || error == ENOSYS;
    throw std::system_error(
        error, std::generic_category(),
        "cannot lock " + path_.string() +
            (no_locks ? " (the file system of this folder does not lock files, and without a lock two runs "
                        "could write the same files; choose a folder on a local disk with -o)"
                      : ""));
  }

  fs::path path_;
  int descriptor_ = -1;
};

RunFolder::RunFolder(fs::path folder, Existing existing, const fs::path& scene,
                     const WriteOptions& write_options)
    : folder_(std::move(folder)) {
  if (folder_.filename().empty() && folder_.has_parent_path())
    folder_ = folder_.parent_path();  // "out/" is "out"
  const fs::file_status status = fs::symlink_status(folder_);
  if (fs::is_symlink(status))
    throw OutputRefused("the output folder " + folder_.string() +
                        " is a symbolic link; give the path of its target");
  if (fs::exists(status) && !fs::is_directory(status))
    throw OutputRefused("the output folder " + folder_.string() + " is a file; choose another name with -o");
  if (!fs::exists(status)) {
    if (existing == Existing::resume)
      throw OutputRefused("there is no run to resume: the folder " + folder_.string() + " does not exist");
    create(write_options);
    return;
  }
  const bool leftovers = refuse_unless_allowed(existing, scene);
  lock_ = std::make_unique<Lock>(folder_);
  refuse_unless_allowed(existing, scene);  // again: a run may have begun and ended before the lock
  remove_unfinished_files();
  complete_beginning();
  if (has_run() && existing == Existing::resume) return;
  if (write_options) write_options(folder_ / kNewRunFile);
  if (existing == Existing::resume || leftovers)
    note_ = "no run had begun in " + folder_.string() + "; the run starts at time 0";
}

/// Creates a folder "NAME.part-PID-N", locks it, and returns its path. folder: path of NAME.
fs::path RunFolder::create_locked(const fs::path& folder) {
  constexpr int kAttempts = 10;
  for (int attempt = 1;; ++attempt) {
    const fs::path unfinished = create_unfinished(folder, attempt - 1);
    try {
      lock_ = std::make_unique<Lock>(unfinished);
      return unfinished;
    } catch (const std::exception& fault) {
      // Before the lock is made, another run may find the folder abandoned, lock it and remove it.
      const bool locked = dynamic_cast<const OutputRefused*>(&fault) != nullptr;
      const bool removed = !exists_at_all(unfinished);
      std::error_code ignored;
      fs::remove_all(unfinished, ignored);
      if (!(locked || removed) || attempt == kAttempts) throw;
    }
  }
}

/// Creates the folder, with the lock and the options.
void RunFolder::create(const WriteOptions& write_options) {
  if (folder_.has_parent_path()) fs::create_directories(folder_.parent_path());
  remove_unfinished_folders(folder_);
  const fs::path unfinished = create_locked(folder_);
  try {
    if (write_options) write_options(unfinished / kNewRunFile);
    std::error_code error;
    fs::rename(unfinished, folder_, error);
    if (error == std::errc::directory_not_empty || error == std::errc::file_exists)
      throw OutputRefused("another process has created the output folder " + folder_.string());
    if (error) throw fs::filesystem_error("cannot rename", unfinished, folder_, error);
    lock_->moved_to(folder_);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(unfinished, ignored);
    throw;
  }
}

/// Throws OutputRefused unless the folder is empty, contains only leftovers of killed processes, or contains
/// a run that may be resumed or replaced. Returns whether there are only leftovers.
bool RunFolder::refuse_unless_allowed(Existing existing, const fs::path& scene) const {
  bool leftovers = false, others = false;
  for (const fs::directory_entry& entry : entries_of(folder_)) {
    if (is_leftover(entry.path().filename()))
      leftovers = true;
    else
      others = true;
  }
  if (!others) return leftovers;
  const bool ours = !begun_run_file(folder_).empty();
  if (existing == Existing::refuse)
    throw OutputRefused("the output folder " + folder_.string() + " is not empty; " +
                        (ours ? "--resume continues the run in it, --force replaces it by a new run"
                              : "choose another with -o"));
  if (!ours)
    throw OutputRefused("the output folder " + folder_.string() +
                        " is not empty and contains no run of pliant (no " + kRunFile +
                        "); choose another with -o");
  if (existing == Existing::force && !scene.empty() && is_in(scene, folder_))
    throw OutputRefused("the scene " + scene.string() + " is in the output folder " + folder_.string() +
                        ", whose files would be removed; choose another folder with -o");
  return false;
}

/// Removes unfinished files. Other processes may write in the folders of frames. In these folders, a file is
/// removed only if no process has locked it and its process does not exist on this machine.
void RunFolder::remove_unfinished_files() {
  std::vector<fs::path> unfinished;
  for (const fs::directory_entry& entry : entries_of(folder_))
    if (is_unfinished(entry.path().filename())) unfinished.push_back(entry.path());
  for (const char* inner : {kMeshFolder, kFrameFolder}) {
    if (!fs::is_directory(fs::symlink_status(folder_ / inner))) continue;
    for (const fs::directory_entry& entry : entries_of(folder_ / inner)) {
      const std::string name = entry.path().filename().string();
      const int process = writing_process(name);
      if (process >= 0 && is_run_file(fs::path(inner) / name) && !process_exists(process) &&
          TriedLock(entry.path()).locked())
        unfinished.push_back(entry.path());
    }
  }
  for (const fs::path& path : unfinished) fs::remove_all(path);
}

bool RunFolder::has_run() const {
  return exists_at_all(folder_ / kRunFile);
}

fs::path RunFolder::new_run() {
  new_run_ = create_unfinished(folder_ / kNewRun);
  return new_run_;
}

void RunFolder::begin_new_run() {
  sync_folder(new_run_);
  fs::rename(new_run_, folder_ / kWholeNewRun);
  new_run_.clear();
  sync_folder(folder_);
  complete_beginning();
}

/// Completes the replacement of an old run by a new one, from the step at which a process was killed.
void RunFolder::complete_beginning() {
  const fs::path whole = folder_ / kWholeNewRun, moving = folder_ / kMovingNewRun;
  if (exists_at_all(whole)) {
    remove_old_run();
    fs::rename(whole, moving);
  }
  if (exists_at_all(folder_ / kRunFile)) fs::remove(folder_ / kNewRunFile);
  if (!exists_at_all(moving)) return;
  for (const fs::path& file : files_of(moving))
    if (file != kRunFile) fs::rename(moving / file, folder_ / file);
  if (exists_at_all(moving / kRunFile)) fs::rename(moving / kRunFile, folder_ / kRunFile);
  fs::remove(moving);
  fs::remove(folder_ / kNewRunFile);
}

/// Removes the files of the old run, run.json first: without run.json the other files are not a run.
void RunFolder::remove_old_run() {
  fs::remove(folder_ / kRunFile);
  for (const fs::path& file : files_of(folder_))
    if (is_run_file(file) && file != kLockFile) fs::remove(folder_ / file);
  for (const char* inner : {kMeshFolder, kFrameFolder}) {
    const fs::path path = folder_ / inner;
    if (fs::is_directory(fs::symlink_status(path)) && fs::is_empty(path)) fs::remove(path);
  }
}

RunFolder::~RunFolder() {
  try {
    if (!new_run_.empty()) fs::remove_all(new_run_);
    if (has_run()) fs::remove(folder_ / kNewRunFile);
  } catch (const std::exception&) {
    // The next run that locks the folder removes these files.
  }
}

fs::path find_run_file(const fs::path& folder) {
  if (!fs::is_directory(folder)) return folder / kRunFile;
  const fs::path begun = begun_run_file(folder);
  if (!begun.empty()) return begun;
  const fs::path options = folder / kNewRunFile;
  return exists_at_all(options) ? options : fs::path();
}

void make_subfolder(const fs::path& folder) {
  const fs::file_status status = fs::symlink_status(folder);
  if (fs::is_directory(status)) return;
  if (fs::exists(status)) throw OutputRefused(folder.string() + " is not a folder");
  fs::create_directory(folder);
}

}  // namespace pliant
