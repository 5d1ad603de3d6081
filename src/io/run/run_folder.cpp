#include <pliant/io/run/run_folder.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <pliant/io/file_fault.h>
#include <pliant/io/run/run_files.h>

namespace fs = std::filesystem;

namespace pliant {
namespace {

bool exists_at_all(const fs::path& path) {
  return fs::symlink_status(path).type() != fs::file_type::not_found;
}

// Returns the paths of all files in a folder and its sub-folders, relative to the folder.
std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_symlink() || !entry.is_directory()) files.push_back(entry.path().lexically_relative(folder));
  return files;
}

bool is_in(const fs::path& file, const fs::path& folder) {
  const fs::path inner = fs::weakly_canonical(file), outer = fs::weakly_canonical(folder);
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

// The lock file, locked by flock: the system releases the lock whenever the process ends.
class RunFolder::Lock {
 public:
  explicit Lock(const fs::path& folder) : path_(folder / kLockFile) {
    for (;;) {
      descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
      if (descriptor_ < 0) throw_file_fault(errno, "write", path_);
      if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        char owner[32] = "";
        const ssize_t length = ::pread(descriptor_, owner, sizeof owner - 1, 0);
        ::close(descriptor_);
        throw OutputRefused("the output folder " + folder.string() + " is in use by another run (process " +
                            (length > 0 ? std::string(owner, static_cast<std::size_t>(length)) : "unknown") +
                            ")");
      }
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
    if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, owner.data(), owner.size(), 0) < 0) {
      const int error = errno;
      ::unlink(path_.c_str());
      ::close(descriptor_);
      throw_file_fault(error, "write", path_, owner.size());
    }
  }
  ~Lock() {
    ::unlink(path_.c_str());
    ::close(descriptor_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  fs::path path_;
  int descriptor_ = -1;
};

RunFolder::RunFolder(fs::path folder, Existing existing, const fs::path& scene) : folder_(std::move(folder)) {
  if (folder_.filename().empty() && folder_.has_parent_path())
    folder_ = folder_.parent_path();  // "out/" is "out"
  const fs::file_status status = fs::symlink_status(folder_);
  if (fs::is_symlink(status))
    throw OutputRefused("the output folder " + folder_.string() +
                        " is a symbolic link; give the path of its target");
  if (fs::exists(status) && !fs::is_directory(status))
    throw OutputRefused("the output folder " + folder_.string() + " is a file");
  if (!fs::exists(status)) {
    if (existing == Existing::resume)
      throw OutputRefused("there is no run to resume: the folder " + folder_.string() + " does not exist");
    fs::create_directories(folder_);
    lock_ = std::make_unique<Lock>(folder_);
    return;
  }

  bool empty = true, ours = exists_at_all(folder_ / kRunFile);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    if (entry.path().filename() != kLockFile) empty = false;
  if (!empty && existing == Existing::refuse)
    throw OutputRefused("the output folder " + folder_.string() + " is not empty; " +
                        (ours ? "--resume continues the run in it, --force replaces it by a new run"
                              : "choose another with -o"));
  if (!empty && !ours)
    throw OutputRefused("the output folder " + folder_.string() +
                        " is not empty and contains no run of pliant (no " + kRunFile +
                        "); choose another with -o");
  if (existing == Existing::resume && !ours)
    throw OutputRefused("there is no run to resume in the folder " + folder_.string());
  lock_ = std::make_unique<Lock>(folder_);
  if (empty || existing != Existing::force) return;
  if (!scene.empty() && is_in(scene, folder_)) {
    throw OutputRefused("the scene " + scene.string() + " is in the output folder " + folder_.string() +
                        ", whose files would be removed; choose another folder with -o");
  }
  for (const fs::path& file : files_of(folder_))
    if (is_run_file(file) && file != kLockFile) fs::remove(folder_ / file);
  for (const char* inner : {kMeshFolder, kFrameFolder}) {
    const fs::path path = folder_ / inner;
    if (fs::is_directory(fs::symlink_status(path)) && fs::is_empty(path)) fs::remove(path);
  }
}

RunFolder::~RunFolder() = default;

void make_subfolder(const fs::path& folder) {
  const fs::file_status status = fs::symlink_status(folder);
  if (fs::is_directory(status)) return;
  if (fs::exists(status)) throw OutputRefused(folder.string() + " is not a folder");
  fs::create_directory(folder);
}

}  // namespace pliant
