#include <pliant/io/format/whole_file.h>

#include <cerrno>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <pliant/io/file_fault.h>

#include <pliant/io/retry.h>

namespace pliant {

void sync_folder(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder.empty() ? "." : folder;
  const int descriptor = retry([&] { return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
  if (descriptor < 0) throw_file_fault(errno, "read", path);
  const int status = retry([&] { return ::fsync(descriptor); });
  const int error = errno;
  ::close(descriptor);
  const bool unsupported = error == EINVAL || error == EROFS;  // some file systems do not sync folders
  if (status != 0 && !unsupported) throw_file_fault(error, "write", path);
}

WholeFile::WholeFile(std::filesystem::path target) : target_(std::move(target)) {
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    name_ = target_;
    name_ += ".part-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
    descriptor_ = retry([&] { return ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); });
    if (descriptor_ < 0 && (errno != EEXIST || attempt >= 1000)) throw_file_fault(errno, "write", target_);
  }
  // The lock shows other processes, also on other machines, that this file is being written. On a file system
  // without locks, the file is written without a lock.
  retry([&] { return ::flock(descriptor_, LOCK_EX | LOCK_NB); });
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!renamed_) ::unlink(name_.c_str());
}

void WholeFile::write(const void* bytes, std::size_t size) {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = retry([&] { return ::write(descriptor_, next, size); });
    if (written < 0) throw_file_fault(errno, "write", target_, size);
    next += written;
    size -= static_cast<std::size_t>(written);
  }
}

void WholeFile::become_target(Durable durable) {
  if (durable == Durable::yes && retry([&] { return ::fsync(descriptor_); }) != 0)
    throw_file_fault(errno, "write", target_);
  const int status = ::close(descriptor_);
  descriptor_ = -1;
  if (status != 0 && errno != EINTR) throw_file_fault(errno, "write", target_);
  if (::rename(name_.c_str(), target_.c_str()) != 0) throw_file_fault(errno, "replace or create", target_);
  renamed_ = true;
}

void write_whole_file(const std::filesystem::path& path, const void* bytes, std::size_t size,
                      Durable durable) {
  WholeFile file(path);
  file.write(bytes, size);
  file.become_target(durable);
}

std::string read_whole_file(const std::filesystem::path& path) {
  const int descriptor = retry([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC); });
  if (descriptor < 0) throw_file_fault(errno, "read", path);
  std::string bytes;
  std::size_t size = 0;
  ssize_t count = 0;
  try {
    do {
      bytes.resize(size + (std::size_t{1} << 16));
      count = retry([&] { return ::read(descriptor, bytes.data() + size, bytes.size() - size); });
      if (count < 0) throw_file_fault(errno, "read", path);
      size += static_cast<std::size_t>(count);
    } while (count > 0);
  } catch (...) {
    ::close(descriptor);
    throw;
  }
  ::close(descriptor);
  bytes.resize(size);
  return bytes;
}

}  // namespace pliant
