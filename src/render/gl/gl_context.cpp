// The backends in the order in which they are tried, and the message if none opens.
#include <pliant/render/gl/gl_context.h>

#include <dlfcn.h>

#include <stdexcept>
#include <utility>

#include "gl_platform.h"

namespace pliant {
namespace {

constexpr unsigned kGlRenderer = 0x1F01, kGlVersion = 0x1F02;

struct Backend {
  const char* name;
  GlBackend backend;
  std::unique_ptr<GlContext::Platform> (*open)();
};
constexpr Backend kBackends[] = {
    {"OSMesa", GlBackend::osmesa, open_osmesa},
    {"EGL surfaceless", GlBackend::egl, open_egl_surfaceless},
    {"EGL software device", GlBackend::egl, open_egl_software_device},
};

std::string gl_string(const GlContext::Platform& platform, unsigned name) {
  const auto get_string =
      reinterpret_cast<const unsigned char* (*)(unsigned)>(platform.function("glGetString"));
  const unsigned char* text = get_string ? get_string(name) : nullptr;
  if (!text) throw std::runtime_error("the context opens but glGetString returns nothing");
  return reinterpret_cast<const char*>(text);
}

// Reads the strings of a context, which proves that it works.
void read_strings(GlContext::Platform& platform, std::string& renderer, std::string& version) {
  platform.make_current();
  renderer = gl_string(platform, kGlRenderer);
  version = gl_string(platform, kGlVersion);
  platform.release();
}

// Opens a context with one backend and reads its strings.
std::unique_ptr<GlContext::Platform> open(const Backend& entry, std::string& renderer, std::string& version) {
  auto platform = entry.open();
  read_strings(*platform, renderer, version);
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
  for (const Backend& entry : kBackends) {
    if (backend != GlBackend::automatic && backend != entry.backend) continue;
    try {
      platform_ = open(entry, renderer_, version_);
      backend_ = entry.name;
      return;
    } catch (const std::runtime_error& error) {
      tried += std::string("\n  ") + entry.name + ": " + error.what();
    }
  }
  const char* packages = backend == GlBackend::osmesa ? "libosmesa6"
                         : backend == GlBackend::egl  ? "libegl1 and libgl1-mesa-dri"
                                                      : "libosmesa6, or libegl1 and libgl1-mesa-dri";
  throw std::runtime_error(std::string("found no OpenGL library for pictures; install ") + packages +
                           " (Debian names). Tried:" + tried);
}

GlContext::GlContext(Loader loader) : platform_(use_current_context(std::move(loader))), backend_("window") {
  read_strings(*platform_, renderer_, version_);
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
  for (const Backend& entry : kBackends) {
    GlProbe probe;
    probe.name = entry.name;
    try {
      open(entry, probe.renderer, probe.version);
      probe.opened = true;
    } catch (const std::runtime_error& error) {
      probe.reason = error.what();
    }
    probes.push_back(std::move(probe));
  }
  return probes;
}

}  // namespace pliant
