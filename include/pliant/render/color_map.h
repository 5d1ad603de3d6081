// The colours that values have in pictures: from dark violet over blue and green to yellow. Equal steps look
// equally far apart, lightness rises all the way, and the common kinds of colour blindness see it too. The
// colours are those of viridis (N. J. Smith, S. van der Walt, E. Firing 2015, given to the public domain,
// CC0) at every tenth; between them light is mixed.
#pragma once

#include <array>

#include <Eigen/Core>

namespace pliant {

inline constexpr int kMapColors = 11;

/// Linear light at levels 0, 0.1, ..., 1.
const std::array<Eigen::Vector3f, kMapColors>& color_map();

/// sRGB, channels in [0, 1], at a level in [0, 1]; levels beyond have the first or the last colour.
Eigen::Vector3f mapped_color(double level);

}  // namespace pliant
