// The bar that tells what the colours of a picture mean.
#pragma once

#include <pliant/io/format/image.h>
#include <pliant/render/picture.h>

namespace pliant {

/// Draws it over the right side of an image: the colours from bottom to top, ticks at round values, above
/// them the title.
void draw_color_bar(Image& image, const Picture::Scale& scale);

}  // namespace pliant
