// A picture in memory: the output of the renderer and the input of the PNG writer.
#pragma once

#include <cstdint>
#include <vector>

namespace pliant {

/// Rows from top to bottom, pixels from left to right, three bytes (red, green, blue; sRGB) per pixel,
/// no padding.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3 bytes
};

}  // namespace pliant
