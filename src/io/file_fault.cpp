#include <pliant/io/file_fault.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace pliant {

void throw_file_fault(int error, const char* action, const std::filesystem::path& path, std::size_t needed) {
  std::string message = std::string("cannot ") + action + " " + path.string();
  if (error == ENOSPC || error == EDQUOT) {
    std::error_code unknown;
    const std::filesystem::space_info space = std::filesystem::space(path.parent_path(), unknown);
    message += " (";
    if (needed > 0) message += std::to_string(needed) + " bytes needed";
    if (!unknown) message += (needed > 0 ? ", " : "") + std::to_string(space.available) + " bytes free";
    message += ")";
  }
  throw std::system_error(error, std::generic_category(), message);
}

}  // namespace pliant
