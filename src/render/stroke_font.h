// Letters drawn as strokes, for the few words in a picture: digits, small letters, blanks and . , - + / ( ).
// Other characters are left blank. Everything is computed, so that a text is the same on every machine.
#pragma once

#include <string>

#include <Eigen/Core>

#include <pliant/io/format/image.h>

namespace pliant {

/// How wide a text is, in heights of its digits.
double text_width(const std::string& text);

/// Draws a text with its lower left corner, on the line that it stands on, at pixels (x, y) from the top
/// left; height: of its digits, pixels. color: sRGB.
void draw_text(Image& image, const std::string& text, double x, double y, double height,
               const Eigen::Vector3f& color);

}  // namespace pliant
