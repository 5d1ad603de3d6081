// Which backends are tried, in which order, and what is said when none opens.
#include <pliant/render/gl/gl_context.h>

#include <dlfcn.h>

#include <stdexcept>

#include "gl_platform.h"

namespace pliant {
namespace {

constexpr unsigned kGlRenderer = 0x1F01, kGlVersion = 0x1F02;

struct Way {
  const char* name;
  GlBackend backend;
  std::unique_ptr<GlContext::Platform> (*open)();
};
constexpr Way kWays[] = {
    {"OSMesa", GlBackend::osmesa, open_osmesa},
    {"EGL surfaceless", GlBackend::egl, open_egl_surfaceless},
    {"EGL software device", GlBackend::egl, open_egl_software_device},
};

std::string gl_string(const GlContext::Platform& platform, unsigned name) {
  const auto get_string =
      reinterpret_cast<const unsigned char* (*)(unsigned)>(platform.function("glGetString"));
  const unsigned char* text = get_string ? get_string(name) : nullptr;
  if (!text) throw std::runtime_error("its context does not answer");
  return reinterpret_cast<const char*>(text);
}

// A context of one way that is known to answer.
std::unique_ptr<GlContext::Platform> open(const Way& way, std::string& renderer, std::string& version) {
  auto platform = way.open();
  platform->make_current();
  renderer = gl_string(*platform, kGlRenderer);
  version = gl_string(*platform, kGlVersion);
  platform->release();
  return platform;
}

}  // namespace

void* open_library(std::initializer_list<const char*> names) {
  std::string reasons;
  for (const char* name : names) {
    if (void* library = ::dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
    const char* reason = ::dlerror();
    reasons += (reasons.empty() ? "" : "; ") + std::string(reason ? reason : name);
  }
  throw std::runtime_error(reasons);
}

void* library_symbol(void* library, const char* name) {
  if (void* symbol = ::dlsym(library, name)) return symbol;
  throw std::runtime_error(std::string("the library has no ") + name);
}

GlContext::GlContext(GlBackend backend) {
  std::string tried;
  for (const Way& way : kWays) {
    if (backend != GlBackend::automatic && backend != way.backend) continue;
    try {
      platform_ = open(way, renderer_, version_);
      backend_ = way.name;
      return;
    } catch (const std::runtime_error& error) {
      tried += std::string("\n  ") + way.name + ": " + error.what();
    }
  }
  const char* packages = backend == GlBackend::osmesa ? "libosmesa6"
                         : backend == GlBackend::egl  ? "libegl1 and libgl1-mesa-dri"
                                                      : "libosmesa6, or libegl1 and libgl1-mesa-dri";
  throw std::runtime_error(std::string("no OpenGL library for pictures: install ") + packages +
                           " (Debian names). Tried:" + tried);
}

GlContext::~GlContext() = default;

void* GlContext::function(const char* name) const {
  return platform_->function(name);
}

GlContext::Current::Current(GlContext& context) : context_(context) {
  context_.platform_->make_current();
}
GlContext::Current::~Current() {
  context_.platform_->release();
}

std::vector<GlProbe> probe_gl_backends() {
  std::vector<GlProbe> probes;
  for (const Way& way : kWays) {
    GlProbe probe;
    probe.name = way.name;
    try {
      open(way, probe.renderer, probe.version);
      probe.opened = true;
    } catch (const std::runtime_error& error) {
      probe.reason = error.what();
    }
    probes.push_back(std::move(probe));
  }
  return probes;
}

}  // namespace pliant
