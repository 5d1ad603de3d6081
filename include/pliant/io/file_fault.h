// Faults of the file system as exceptions that say what was tried, where, and why it failed.
#pragma once

#include <cstddef>
#include <filesystem>

namespace pliant {

/// Throws std::system_error "cannot ACTION PATH: reason" for a value of errno. Of a full disk the message
/// tells how much is free, and `needed` bytes when they are known.
[[noreturn]] void throw_file_fault(int error, const char* action, const std::filesystem::path& path,
                                   std::size_t needed = 0);

}  // namespace pliant
