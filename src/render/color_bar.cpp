// Layout of the colour bar. The unit of lengths is the height of a digit, which is proportional to the height
// of the image, but at least 6 pixels.
#include "color_bar.h"

#include <algorithm>
#include <cmath>

#include <pliant/render/color_map.h>
#include <pliant/render/ticks.h>

#include "stroke_font.h"

namespace pliant {
namespace {

constexpr int kMinImageWidth = 160, kMinImageHeight = 120;  // pixels
constexpr double kDigitHeight = 1.0 / 46;                   // height of a digit / height of the image
constexpr double kPadding = 0.8, kBarWidth = 1.3, kTickLength = 0.4;
constexpr double kBarHeight = 0.5;  // height of the bar / height of the image
constexpr float kPaper = 0.8f;      // opacity of the panels
const Eigen::Vector3f kWhite(1, 1, 1), kInk(0.16f, 0.17f, 0.2f);

struct PixelRectangle {
  int left, top, right, bottom;  // pixels; right and bottom are excluded
};

// Fills a rectangle. share: opacity; color_of_row(y): function that returns the colour of row y.
template <class ColorOfRow>
void fill(Image& image, const PixelRectangle& box, float share, ColorOfRow&& color_of_row) {
  for (int y = std::max(0, box.top); y < std::min(image.height, box.bottom); ++y) {
    const Eigen::Vector3f color = color_of_row(y);
    for (int x = std::max(0, box.left); x < std::min(image.width, box.right); ++x) {
      std::uint8_t* pixel = image.rgb.data() + (static_cast<std::size_t>(y) * image.width + x) * 3;
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(
            std::lround(static_cast<float>(pixel[c]) * (1 - share) + 255 * share * color[c]));
    }
  }
}
void fill(Image& image, const PixelRectangle& box, const Eigen::Vector3f& color, float share = 1) {
  fill(image, box, share, [&](int) { return color; });
}

int pixels(double length) {
  return static_cast<int>(std::lround(length));
}

}  // namespace

void draw_color_bar(Image& image, const Picture::Scale& scale) {
  if (image.width < kMinImageWidth || image.height < kMinImageHeight) return;
  const double digit = std::max(6.0, kDigitHeight * image.height);
  const int line = std::max(1, pixels(0.12 * digit)), padding = pixels(kPadding * digit);
  const std::vector<Tick> marks = ticks(scale.low, scale.high);
  double widest = 0;
  for (const Tick& mark : marks) widest = std::max(widest, text_width(mark.label));
  const int bar_width = pixels(kBarWidth * digit), bar_height = pixels(kBarHeight * image.height),
            tick = pixels(kTickLength * digit), labels = pixels(widest * digit),
            title = pixels(text_width(scale.title) * digit),
            title_height = pixels((1 + 2 * kPadding) * digit);

  // The panel of the title is above the panel of the bar; both end at the right side of the image.
  const int panel_height = bar_height + 2 * padding, top = (image.height - panel_height - title_height) / 2;
  const PixelRectangle title_panel{image.width - title - 2 * padding, top, image.width, top + title_height};
  const PixelRectangle panel{image.width - bar_width - 2 * tick - labels - 2 * padding, title_panel.bottom,
                             image.width, title_panel.bottom + panel_height};
  fill(image, title_panel, kWhite, kPaper);
  fill(image, panel, kWhite, kPaper);
  draw_text(image, scale.title, title_panel.left + padding, title_panel.bottom - kPadding * digit, digit,
            kInk);

  const PixelRectangle bar{panel.left + padding, panel.top + padding, panel.left + padding + bar_width,
                           panel.bottom - padding};
  fill(image, {bar.left - line, bar.top - line, bar.right + line, bar.bottom + line}, kInk);
  fill(image, bar, 1, [&](int y) { return mapped_color((bar.bottom - y - 0.5) / bar_height); });
  for (const Tick& mark : marks) {
    const double y = bar.bottom - bar_height * (mark.value - scale.low) / (scale.high - scale.low);
    const int row = pixels(y - 0.5 * line);
    fill(image, {bar.right, row, bar.right + tick, row + line}, kInk);
    draw_text(image, mark.label, bar.right + 2 * tick, y + 0.5 * digit, digit, kInk);
  }
}

}  // namespace pliant
