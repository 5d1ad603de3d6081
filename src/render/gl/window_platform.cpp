// The context of a window: the caller has made it current, and keeps it current.
#include <utility>

#include "gl_platform.h"

namespace pliant {
namespace {

class WindowPlatform : public GlContext::Platform {
 public:
  explicit WindowPlatform(GlContext::Loader loader) : loader_(std::move(loader)) {}
  void make_current() override {}
  void release() override {}
  void* function(const char* name) const override { return loader_(name); }

 private:
  GlContext::Loader loader_;
};

}  // namespace

std::unique_ptr<GlContext::Platform> use_current_context(GlContext::Loader loader) {
  return std::make_unique<WindowPlatform>(std::move(loader));
}

}  // namespace pliant
