// The eleven colours of viridis, in linear light, and their interpolation.
#include <pliant/render/color_map.h>

#include <algorithm>

#include "srgb.h"

namespace pliant {
namespace {

constexpr std::array<std::array<int, 3>, kMapColors> kViridis{{{0x44, 0x01, 0x54},
                                                               {0x48, 0x24, 0x75},
                                                               {0x41, 0x44, 0x87},
                                                               {0x35, 0x5f, 0x8d},
                                                               {0x2a, 0x78, 0x8e},
                                                               {0x21, 0x91, 0x8c},
                                                               {0x22, 0xa8, 0x84},
                                                               {0x44, 0xbf, 0x70},
                                                               {0x7a, 0xd1, 0x51},
                                                               {0xbd, 0xdf, 0x26},
                                                               {0xfd, 0xe7, 0x25}}};

std::array<Eigen::Vector3f, kMapColors> linear_map() {
  std::array<Eigen::Vector3f, kMapColors> map;
  for (std::size_t i = 0; i < map.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      map[i][static_cast<Eigen::Index>(c)] = linear_light(static_cast<float>(kViridis[i][c]) / 255);
  return map;
}

}  // namespace

const std::array<Eigen::Vector3f, kMapColors>& color_map() {
  static const std::array<Eigen::Vector3f, kMapColors> map = linear_map();
  return map;
}

Eigen::Vector3f mapped_color(double level) {
  const double at = std::clamp(level, 0.0, 1.0) * (kMapColors - 1);
  const int below = std::min(static_cast<int>(at), kMapColors - 2);
  const auto share = static_cast<float>(at - below);
  const Eigen::Vector3f light = (1 - share) * color_map()[static_cast<std::size_t>(below)] +
                                share * color_map()[static_cast<std::size_t>(below) + 1];
  return light.unaryExpr([](float channel) { return static_cast<float>(srgb_channel(channel)); });
}

}  // namespace pliant
