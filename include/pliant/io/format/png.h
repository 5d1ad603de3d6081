// Writing pictures as PNG files.
#pragma once

#include <filesystem>

#include <pliant/io/format/image.h>

namespace pliant {

/// Writes a picture with 8 bits per channel, sRGB. Equal images give equal bytes. The file is whole or absent
/// (io/format/whole_file.h). Throws std::invalid_argument if the size of the image does not match its bytes,
/// std::system_error or std::runtime_error with path and reason if the file cannot be written.
void write_png(const Image& image, const std::filesystem::path& path);

/// Checks the structure of a PNG file and the checksums of its chunks. Throws std::system_error if the file
/// cannot be read, std::runtime_error with path and reason if it is damaged.
void check_png(const std::filesystem::path& path);

/// Returns the version of the PNG library in use.
const char* png_library_version();

}  // namespace pliant
