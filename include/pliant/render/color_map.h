// The colour map for values in pictures, from dark violet over blue and green to yellow. Equal steps of the
// scale look about equally different, the lightness increases along the scale, and the map is readable with
// the common kinds of colour blindness. The map has the colours of viridis (N. J. Smith, S. van der Walt, E.
// Firing 2015, public domain, CC0) at every tenth of the scale and interpolates them in linear light.
#pragma once

#include <array>

#include <Eigen/Core>

namespace pliant {

inline constexpr int kMapColors = 11;

/// Returns the colours in linear light at levels 0, 0.1, ..., 1.
const std::array<Eigen::Vector3f, kMapColors>& color_map();

/// Returns the sRGB colour (channels in [0, 1]) at a level, the position on the scale from 0 to 1. Levels
/// outside have the first or the last colour.
Eigen::Vector3f mapped_color(double level);

}  // namespace pliant
