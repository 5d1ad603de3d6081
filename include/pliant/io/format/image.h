// A picture in memory: the output of the renderer and the input of the PNG writer.
#pragma once

#include <cstdint>
#include <vector>

namespace pliant {

/// The rows are from top to bottom, and the pixels of a row from left to right. A pixel has three bytes
/// (red, green, blue; sRGB). There is no padding.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3 bytes
};

}  // namespace pliant
