// Computes the image from 2 x 2 samples for each pixel.
#pragma once

#include <cstdint>
#include <vector>

#include <pliant/io/format/image.h>

namespace pliant {

/// Returns the sRGB image, rows from top to bottom. samples: (2 width) x (2 height) x 4 bytes, rows from
/// bottom to top; each channel is the square root of linear light. The mean is computed in linear light, in
/// integers.
Image resolve(const std::vector<std::uint8_t>& samples, int width, int height);

}  // namespace pliant
