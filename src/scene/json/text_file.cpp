#include <pliant/scene/json/text_file.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include <pliant/math/nearest_name.h>
#include <pliant/scene/diagnostics.h>

namespace pliant {

namespace {

namespace fs = std::filesystem;

/// Returns "; did you mean "NAME"?" with the most similar name in the folder of a path that does not exist.
/// If no name is similar, returns an empty text. If the folder does not exist, returns a text that says so.
std::string nearest_file(const fs::path& path) {
  std::error_code ignored;
  std::vector<std::string> names;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) return "; the folder " + folder.string() + " does not exist either";
  for (fs::directory_iterator entry(folder, ignored), end; entry != end && !ignored;
       entry.increment(ignored)) {
    names.push_back(entry->path().filename().string());
  }
  return did_you_mean(path.filename().string(), names);
}

[[noreturn]] void refuse_size(const std::string& path, const std::string& size, std::size_t max_bytes) {
  throw FileError(FileError::Reason::kTooLarge, escaped(path) + ": " + size + "; the limit is " +
                                                    std::to_string(max_bytes >> 20) + " MiB (" +
                                                    std::to_string(max_bytes) + " bytes)");
}

/// Opens a file. Repeats the call if a signal interrupts it.
std::FILE* open_to_read(const std::string& path) {
  for (;;) {
    std::FILE* const file = std::fopen(path.c_str(), "rb");
    if (file != nullptr || errno != EINTR) return file;
  }
}

}  // namespace

std::string read_text_file(const std::string& path, std::size_t max_bytes) {
  const auto refuse = [&](int error) {
    const bool missing = error == ENOENT;
    throw FileError(
        missing ? FileError::Reason::kMissing : FileError::Reason::kNotReadable,
        escaped(path + ": cannot read: " + std::strerror(error) + (missing ? nearest_file(path) : "")));
  };
  const bool standard_input = path == "-";
  if (!standard_input) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_directory(status)) refuse(EISDIR);
    if (fs::is_regular_file(status)) {
      const std::uintmax_t size = fs::file_size(path, error);
      if (!error && size > max_bytes)
        refuse_size(path, "the file has " + std::to_string(size) + " bytes", max_bytes);
    }
  }
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> opened(standard_input ? nullptr : open_to_read(path),
                                                         [](std::FILE* f) { return f ? std::fclose(f) : 0; });
  if (!standard_input && !opened) refuse(errno);
  std::FILE* const file = standard_input ? stdin : opened.get();

  std::string text;
  std::vector<char> block(1 << 16);
  for (;;) {
    errno = 0;
    const std::size_t n = std::fread(block.data(), 1, block.size(), file);
    text.append(block.data(), n);
    if (text.size() > max_bytes) refuse_size(path, "more bytes than allowed", max_bytes);
    if (std::ferror(file) && errno == EINTR) {  // a signal interrupted the call
      std::clearerr(file);
      continue;
    }
    if (n < block.size()) {
      if (std::ferror(file)) refuse(errno == 0 ? EIO : errno);
      return text;
    }
  }
}

}  // namespace pliant
