// The transfer function of sRGB (IEC 61966-2-1) and its inverse.
#include "srgb.h"

#include <cmath>

namespace pliant {

float linear_light(float srgb) {
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

double srgb_channel(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

}  // namespace pliant
