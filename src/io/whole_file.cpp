// Temporary name, write, checked close, rename; the temporary file goes away on every failure.
#include <pliant/io/whole_file.h>

#include <cerrno>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace pliant {
namespace {

[[noreturn]] void fail(int error, const char* action, const std::filesystem::path& path) {
  throw std::system_error(error, std::generic_category(),
                          std::string("cannot ") + action + " " + path.string());
}

// A file of its own beside the target, removed on destruction unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target) : target_(target) {
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
      name_ = target;
      name_ += ".part-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
      descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && (errno != EEXIST || attempt >= 1000)) fail(errno, "write", target_);
    }
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(const char* bytes, std::size_t size) {
    while (size > 0) {
      const ssize_t written = ::write(descriptor_, bytes, size);
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(errno, "write", target_);
      bytes += written;
      size -= static_cast<std::size_t>(written);
    }
  }

  void become_target() {
    const int status = ::close(descriptor_);
    descriptor_ = -1;
    if (status != 0) fail(errno, "write", target_);
    if (::rename(name_.c_str(), target_.c_str()) != 0) fail(errno, "put in place", target_);
    renamed_ = true;
  }

 private:
  std::filesystem::path target_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

}  // namespace

void write_whole_file(const std::filesystem::path& path, const void* bytes, std::size_t size) {
  TemporaryFile file(path);
  file.write(static_cast<const char*>(bytes), size);
  file.become_target();
}

}  // namespace pliant
