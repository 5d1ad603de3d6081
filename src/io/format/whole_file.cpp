#include <pliant/io/format/whole_file.h>

#include <cerrno>
#include <string>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <pliant/io/file_fault.h>

namespace pliant {

WholeFile::WholeFile(std::filesystem::path target) : target_(std::move(target)) {
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    name_ = target_;
    name_ += ".part-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
    descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EINTR && (errno != EEXIST || attempt >= 1000))
      throw_file_fault(errno, "write", target_);
  }
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!renamed_) ::unlink(name_.c_str());
}

void WholeFile::write(const void* bytes, std::size_t size) {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = ::write(descriptor_, next, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_file_fault(errno, "write", target_, size);
    next += written;
    size -= static_cast<std::size_t>(written);
  }
}

void WholeFile::become_target(Durable durable) {
  if (durable == Durable::yes && ::fsync(descriptor_) != 0) throw_file_fault(errno, "write", target_);
  const int status = ::close(descriptor_);
  descriptor_ = -1;
  if (status != 0) throw_file_fault(errno, "write", target_);
  if (::rename(name_.c_str(), target_.c_str()) != 0) throw_file_fault(errno, "replace or create", target_);
  renamed_ = true;
}

void write_whole_file(const std::filesystem::path& path, const void* bytes, std::size_t size,
                      Durable durable) {
  WholeFile file(path);
  file.write(bytes, size);
  file.become_target(durable);
}

}  // namespace pliant
