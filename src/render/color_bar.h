// The bar that explains the colours of a picture.
#pragma once

#include <pliant/io/format/image.h>
#include <pliant/render/picture.h>

namespace pliant {

/// Draws the bar over the right side of an image: the colours from bottom to top, ticks at round values, and
/// the title above.
void draw_color_bar(Image& image, const Picture::Scale& scale);

}  // namespace pliant
