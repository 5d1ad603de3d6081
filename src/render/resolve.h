// From 2x2 samples a pixel to the picture.
#pragma once

#include <cstdint>
#include <vector>

#include <pliant/io/format/image.h>

namespace pliant {

/// samples: (2 width) x (2 height) x 4 bytes, rows from bottom to top, each channel the square root of linear
/// light. The mean is taken in linear light, in whole numbers; the image is sRGB, rows from top to bottom.
Image resolve(const std::vector<std::uint8_t>& samples, int width, int height);

}  // namespace pliant
