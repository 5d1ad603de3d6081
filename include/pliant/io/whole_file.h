// Files that are whole or absent: written under a temporary name beside the target, closed with a check, then
// renamed.
#pragma once

#include <cstddef>
#include <filesystem>

namespace pliant {

/// Makes `path` hold exactly these bytes, replacing a file of that name. A reader sees the old file or the
/// new one, never a part. Throws std::system_error with path and reason; nothing is left behind then.
void write_whole_file(const std::filesystem::path& path, const void* bytes, std::size_t size);

}  // namespace pliant
