// Conversion between sRGB channels and linear light (IEC 61966-2-1), both in [0, 1].
#pragma once

namespace pliant {

/// Returns the linear light of an sRGB channel.
float linear_light(float srgb);
/// Returns the sRGB channel of linear light.
double srgb_channel(double light);

}  // namespace pliant
