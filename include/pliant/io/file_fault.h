// Faults of the file system as exceptions with the attempted action, the path and the reason.
#pragma once

#include <cstddef>
#include <filesystem>

namespace pliant {

/// Throws std::system_error "cannot ACTION PATH: reason" for a value of errno. For a full disk or an exceeded
/// quota, the message also contains the free bytes and, if not 0, the `needed` bytes.
[[noreturn]] void throw_file_fault(int error, const char* action, const std::filesystem::path& path,
                                   std::size_t needed = 0);

}  // namespace pliant
