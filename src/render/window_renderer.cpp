// One pipeline for each quality, made again when the size of the window changes.
#include <pliant/render/window_renderer.h>

#include <array>
#include <utility>
#include <vector>

#include "pipeline.h"

namespace pliant {
namespace {

/// Side of the shadow map of drafts with a sample for each pixel, texels.
constexpr int kDraftShadowSide = 1024;

PassSizes sizes_of(int width, int height, WindowRenderer::Quality quality) {
  PassSizes sizes = pass_sizes(width, height);
  sizes.samples = WindowRenderer::samples(quality);
  if (quality != WindowRenderer::Quality::full) {
    sizes.shadow_side = static_cast<int>(kDraftShadowSide * sizes.samples);
    sizes.contact_side = 32;
    sizes.occlusion = false;
  }
  return sizes;
}

}  // namespace

class WindowRenderer::Impl {
 public:
  explicit Impl(GlContext::Loader loader) : context(std::move(loader)), gl(context) {}

  /// A pipeline and the size of its pictures, pixels.
  struct Sized {
    std::unique_ptr<Pipeline> pipeline;
    int width = 0, height = 0;
  };

  GlContext context;
  gl::Functions gl;
  std::array<Sized, kQualities> by_quality;
  Pipeline* last = nullptr;  // the pipeline that drew the last picture
};

WindowRenderer::WindowRenderer(GlContext::Loader loader) : impl_(std::make_unique<Impl>(std::move(loader))) {}
WindowRenderer::~WindowRenderer() = default;

void WindowRenderer::draw(const Picture& picture, int width, int height, Quality quality) {
  Impl::Sized& sized = impl_->by_quality[static_cast<std::size_t>(quality)];
  if (!sized.pipeline || sized.width != width || sized.height != height) {
    if (impl_->last == sized.pipeline.get()) impl_->last = nullptr;
    sized.pipeline.reset();
    sized = {std::make_unique<Pipeline>(impl_->context, sizes_of(width, height, quality)), width, height};
  }
  sized.pipeline->draw_to_window(picture);
  impl_->last = sized.pipeline.get();
}

void WindowRenderer::draw_again() {
  if (impl_->last != nullptr) impl_->last->present();
}

Image WindowRenderer::read(int width, int height) {
  const gl::Functions& gl = impl_->gl;
  const std::size_t row = static_cast<std::size_t>(width) * 4;
  std::vector<std::uint8_t> pixels(row * static_cast<std::size_t>(height));
  gl.bind_framebuffer(gl::kFramebuffer, 0);
  gl.pixel_store(gl::kPackAlignment, 4);
  gl.read_pixels(0, 0, width, height, gl::kRgba, gl::kUnsignedByte, pixels.data());
  Image image{width, height, {}};
  image.rgb.reserve(pixels.size() / 4 * 3);
  for (int y = height - 1; y >= 0; --y)
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* pixel =
          pixels.data() + static_cast<std::size_t>(y) * row + 4 * static_cast<std::size_t>(x);
      image.rgb.insert(image.rgb.end(), pixel, pixel + 3);
    }
  return image;
}

const std::string& WindowRenderer::device() const {
  return impl_->context.renderer();
}

}  // namespace pliant
