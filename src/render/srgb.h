// sRGB channels and the linear light that they stand for (IEC 61966-2-1), both in [0, 1].
#pragma once

namespace pliant {

float linear_light(float srgb);
double srgb_channel(double light);

}  // namespace pliant
