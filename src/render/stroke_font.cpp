// A glyph is a list of strokes. A stroke is a chain of points, each given by two digits, x and y. The
// baseline is y = 2; small letters end at y = 6, digits at y = 8, and descenders at y = 0.
#include "stroke_font.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace pliant {
namespace {

constexpr double kLine = 2, kDigitHeight = 6, kGap = 1.6, kBlank = 2, kHalfWidth = 0.42;  // units of the grid

struct Glyph {
  char letter;
  const char* strokes;
};
constexpr Glyph kGlyphs[] = {
    {'0', "120307183847433212"},
    {'1', "071822"},
    {'2', "07183847460242"},
    {'3', "0718384746354443321203 1535"},
    {'4', "32380444"},
    {'5', "480805354443321203"},
    {'6', "473818070312324344351504"},
    {'7', "084812"},
    {'8', "15060718384746351504031232434435"},
    {'9', "031232434738180706153546"},
    {'.', "0202"},
    {',', "1201"},
    {'-', "0535"},
    {'+', "0545 2327"},
    {'/', "0148"},
    {'(', "19070311"},
    {')', "09171301"},
    {'a', "4536160503123243 4642"},
    {'b', "0802 0516364543321203"},
    {'c', "4536160503123243"},
    {'d', "4536160503123243 4842"},
    {'e', "04444536160503123243"},
    {'f', "38281712 0636"},
    {'g', "4536160503123243 46413010"},
    {'h', "0802 0516364542"},
    {'i', "0602 0808"},
    {'j', "161100 1818"},
    {'k', "0802 0436 1532"},
    {'l', "0802"},
    {'m', "0602 0516263532 3546566562"},
    {'n', "0602 0516364542"},
    {'o', "163645433212030516"},
    {'p', "0600 0516364543321203"},
    {'q', "4536160503123243 4640"},
    {'r', "0602 05163645"},
    {'s', "45361605143443321203"},
    {'t', "18132232 0636"},
    {'u', "0603123243 4642"},
    {'v', "062246"},
    {'w', "0612365266"},
    {'x', "0642 0246"},
    {'y', "0622 4610"},
    {'z', "06460242"},
};

const char* strokes_of(char letter) {
  for (const Glyph& glyph : kGlyphs)
    if (glyph.letter == letter) return glyph.strokes;
  return "";
}

// Returns the largest x of the strokes; kBlank if there are none.
double reach(std::string_view strokes) {
  if (strokes.empty()) return kBlank;
  int most = 0;
  for (std::size_t i = 0; i < strokes.size(); i += strokes[i] == ' ' ? 1 : 2)
    if (strokes[i] != ' ') most = std::max(most, strokes[i] - '0');
  return most;
}

Eigen::Vector2d point(std::string_view two) {
  return {two[0] - '0', two[1] - '0'};
}

double distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0;
  return (p - a - share * along).norm();
}

// Returns the distance of a point of the grid from the nearest stroke.
double distance(const Eigen::Vector2d& p, std::string_view strokes) {
  double least = 100;
  for (std::size_t i = 0; i + 3 < strokes.size(); i += 2)
    if (strokes[i + 2] == ' ')
      ++i;  // the next stroke
    else
      least = std::min(least, distance(p, point(strokes.substr(i, 2)), point(strokes.substr(i + 2, 2))));
  return least;
}

void mix(Image& image, int x, int y, const Eigen::Vector3f& color, double share) {
  std::uint8_t* pixel = image.rgb.data() + (static_cast<std::size_t>(y) * image.width + x) * 3;
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + share * (255.0 * color[c] - pixel[c])));
}

}  // namespace

double text_width(const std::string& text) {
  double width = 0;
  for (const char letter : text) width += reach(strokes_of(letter)) + kGap;
  return std::max(0.0, width - kGap) / kDigitHeight;
}

void draw_text(Image& image, const std::string& text, double x, double y, double height,
               const Eigen::Vector3f& color) {
  const double unit = height / kDigitHeight, half_width = std::max(0.5, kHalfWidth * unit);
  for (const char letter : text) {
    const std::string_view strokes = strokes_of(letter);
    const double wide = reach(strokes);
    const int left = std::max(0, static_cast<int>(x - half_width - 1)),
              right = std::min(image.width - 1, static_cast<int>(x + wide * unit + half_width + 1)),
              top = std::max(0, static_cast<int>(y - (9 - kLine) * unit - half_width - 1)),
              bottom = std::min(image.height - 1, static_cast<int>(y + kLine * unit + half_width + 1));
    for (int j = top; j <= bottom; ++j)
      for (int i = left; i <= right; ++i) {
        const Eigen::Vector2d p((i + 0.5 - x) / unit, kLine + (y - j - 0.5) / unit);
        const double share = half_width + 0.5 - unit * distance(p, strokes);
        if (share > 0) mix(image, i, j, color, std::min(1.0, share));
      }
    x += (wide + kGap) * unit;
  }
}

}  // namespace pliant
