// Connects the context and the passes: every call makes the context current for its duration.
#include <pliant/render/renderer.h>

#include <stdexcept>

#include "pipeline.h"

namespace pliant {
class Renderer::Impl {
 public:
  Impl(const PassSizes& sizes, GlBackend backend)
      : width(sizes.width), height(sizes.height), context(backend) {
    const GlContext::Current current(context);
    pipeline = std::make_unique<Pipeline>(context, sizes);
  }
  ~Impl() {
    try {
      const GlContext::Current current(context);
      pipeline.reset();
    } catch (const std::runtime_error&) {
      // The GL objects cannot be deleted, because the context is not current. They end with the context.
      pipeline.release();  // NOLINT(bugprone-unused-return-value)
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  int width, height;
  GlContext context;
  std::unique_ptr<Pipeline> pipeline;
};

Renderer::Renderer(int width, int height, GlBackend backend)
    : impl_(std::make_unique<Impl>(pass_sizes(width, height), backend)) {}
Renderer::~Renderer() = default;

Image Renderer::draw(const Picture& picture) {
  const GlContext::Current current(impl_->context);
  return impl_->pipeline->draw(picture);
}

int Renderer::width() const {
  return impl_->width;
}
int Renderer::height() const {
  return impl_->height;
}
const std::string& Renderer::backend() const {
  return impl_->context.backend();
}
const std::string& Renderer::device() const {
  return impl_->context.renderer();
}

}  // namespace pliant
