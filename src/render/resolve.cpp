// A sample byte v means the linear light v^2 / 255^2, so that the sum of four samples is exact in integers.
#include "resolve.h"

#include <cmath>

#include "srgb.h"

namespace pliant {
namespace {

constexpr int kMaxLight = 255 * 255;

// Returns the sRGB byte for each value of the rounded mean of four squared sample bytes, from 0 to 255^2.
std::vector<std::uint8_t> srgb_table() {
  std::vector<std::uint8_t> table(kMaxLight + 1);
  for (int i = 0; i <= kMaxLight; ++i) {
    const double light = static_cast<double>(i) / kMaxLight;
    table[i] = static_cast<std::uint8_t>(std::lround(255 * srgb_channel(light)));
  }
  return table;
}

int square(std::uint8_t v) {
  return v * v;
}

}  // namespace

Image resolve(const std::vector<std::uint8_t>& samples, int width, int height) {
  static const std::vector<std::uint8_t> srgb = srgb_table();
  Image image{width, height, {}};
  image.rgb.resize(static_cast<std::size_t>(width) * height * 3);
  const std::size_t row_bytes = static_cast<std::size_t>(width) * 8;
  std::uint8_t* out = image.rgb.data();
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* low = samples.data() + static_cast<std::size_t>(2 * (height - 1 - y)) * row_bytes;
    const std::uint8_t* high = low + row_bytes;
    for (int x = 0; x < width; ++x, low += 8, high += 8, out += 3)
      for (int c = 0; c < 3; ++c)
        out[c] = srgb[(square(low[c]) + square(low[c + 4]) + square(high[c]) + square(high[c + 4]) + 2) / 4];
  }
  return image;
}

}  // namespace pliant
