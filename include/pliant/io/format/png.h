// Writes pictures as PNG files.
#pragma once

#include <filesystem>

#include <pliant/io/format/image.h>

namespace pliant {

/// 8 bits a channel, sRGB; the same image always gives the same bytes. The file is whole or absent
/// (io/whole_file.h). Throws std::invalid_argument when the image's size does not fit its bytes,
/// std::system_error or std::runtime_error with path and reason when the file cannot be written.
void write_png(const Image& image, const std::filesystem::path& path);

/// Version of the PNG library in use.
const char* png_library_version();

}  // namespace pliant
