#include "mesh_bytes.h"

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/text_file.h>

namespace pliant {

std::string read_mesh_bytes(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status) &&
      !std::filesystem::is_regular_file(status))
    throw FileError(
        FileError::Reason::kNotReadable,
        escaped(file.string()) + ": cannot read: it is a pipe or a device; expected a regular file");
  // A file named "-" is not standard input.
  return read_text_file(file == "-" ? "./-" : file.string(), kMaxMeshBytes);
}

}  // namespace pliant
