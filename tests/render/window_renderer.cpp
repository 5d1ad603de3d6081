// Pictures in a window. The framebuffer of OSMesa, 16 x 16 pixels, replaces the window.
#include <pliant/render/window_renderer.h>

#include <algorithm>
#include <cstdlib>

#include "catch.h"
#include "scenes.h"

#include <pliant/render/renderer.h>

namespace window_renderer_test {

using namespace pliant;

namespace {

constexpr int kSide = 16;

int largest_difference(const Image& a, const Image& b) {
  REQUIRE(a.rgb.size() == b.rgb.size());
  int largest = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) largest = std::max(largest, std::abs(a.rgb[i] - b.rgb[i]));
  return largest;
}

}  // namespace

TEST_CASE("a window has the pixels of an image, in full quality and nearly in draft quality") {
  const TriangleMesh ball = test::sphere({0, 0, 0.6}, 0.5);
  Picture picture;
  picture.bodies.push_back({&ball, {0.7f, 0.4f, 0.2f}});
  picture.camera = {{0, -4, 1}, {0, 0, 0.5}, {0, 0, 1}, 30};
  picture.tracks.push_back({{{-0.5, -0.6, 0.6}, {0.5, -0.6, 0.6}}});
  std::unique_ptr<GlContext> window;
  try {
    window = std::make_unique<GlContext>(GlBackend::osmesa);
  } catch (const std::runtime_error&) {
    WARN("skipped: there is no OSMesa");
    return;
  }
  const Image image = Renderer(kSide, kSide, GlBackend::osmesa).draw(picture);
  const GlContext::Current current(*window);
  WindowRenderer renderer([&](const char* name) { return window->function(name); });
  renderer.draw(picture, kSide, kSide, WindowRenderer::Quality::full);
  // The shader computes sRGB in single precision, the image in integers.
  CHECK(largest_difference(renderer.read(kSide, kSide), image) <= 1);
  const Image full = renderer.read(kSide, kSide);
  // The more samples a draft has, the less it differs from the picture in full quality.
  double last = 20;
  for (const auto quality : {WindowRenderer::Quality::half_draft, WindowRenderer::Quality::two_thirds_draft,
                             WindowRenderer::Quality::draft}) {
    renderer.draw(picture, kSide, kSide, quality);
    const Image draft = renderer.read(kSide, kSide);
    double sum = 0;
    for (std::size_t i = 0; i < full.rgb.size(); ++i) sum += std::abs(full.rgb[i] - draft.rgb[i]);
    const double mean = sum / static_cast<double>(full.rgb.size());
    CHECK(mean > 0);
    CHECK(mean < last);
    last = mean;
  }
  renderer.draw(picture, 8, 8, WindowRenderer::Quality::full);
  renderer.draw(picture, kSide, kSide, WindowRenderer::Quality::full);
  renderer.draw_again();
  CHECK(largest_difference(renderer.read(kSide, kSide), full) == 0);
  CHECK_THROWS_AS(renderer.draw(picture, 0, 8, WindowRenderer::Quality::full), std::invalid_argument);
}

TEST_CASE("a path on top is visible behind a body, and edges darken a body") {
  const TriangleMesh ball = test::sphere({0, 0, 0}, 1, 6, 12);
  Picture picture;
  picture.bodies.push_back({&ball, {0.8f, 0.8f, 0.8f}});
  picture.ground.shown = false;
  picture.camera = {{0, -6, 0}, {0, 0, 0}, {0, 0, 1}, 30};
  picture.tracks.push_back({{{0, 2, 0}}, {1, 0, 0}, 12});
  Renderer renderer(64, 64);
  const auto middle = [&] { return test::pixel(renderer.draw(picture), 32, 32); };
  const auto hidden = middle();
  picture.tracks[0].on_top = true;
  const auto shown = middle();
  CHECK(shown[0] > 200);
  CHECK(shown[1] < hidden[1] - 50);
  picture.tracks.clear();
  const Image plain = renderer.draw(picture);
  picture.edges = true;
  const Image edged = renderer.draw(picture);
  int darker = 0;
  for (std::size_t i = 0; i < plain.rgb.size(); i += 3) darker += edged.rgb[i] < plain.rgb[i] - 40 ? 1 : 0;
  CHECK(darker > 100);
  CHECK(darker < 2000);
}

}  // namespace window_renderer_test
