// Letters drawn as strokes for the words in a picture: digits, small letters, blanks and . , - + / ( ). Other
// characters are drawn as blanks. No font file is used, so that a text is equal on every machine.
#pragma once

#include <string>

#include <Eigen/Core>

#include <pliant/io/format/image.h>

namespace pliant {

/// Returns the width of a text, in heights of its digits.
double text_width(const std::string& text);

/// Draws a text. x, y: left end of the baseline, pixels from the top left; height: height of the digits,
/// pixels; color: sRGB.
void draw_text(Image& image, const std::string& text, double x, double y, double height,
               const Eigen::Vector3f& color);

}  // namespace pliant
