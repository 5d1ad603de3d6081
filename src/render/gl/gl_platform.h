// What a backend does for GlContext. The libraries stay loaded until the process ends: Mesa's threads and
// exit handlers do not survive dlclose.
#pragma once

#include <memory>

#include <pliant/render/gl/gl_context.h>

namespace pliant {

struct GlContext::Platform {
  virtual ~Platform() = default;
  virtual void make_current() = 0;  ///< throws std::runtime_error
  virtual void release() = 0;
  virtual void* function(const char* name) const = 0;
};

// Each throws std::runtime_error with the reason.
std::unique_ptr<GlContext::Platform> open_osmesa();
std::unique_ptr<GlContext::Platform> open_egl_surfaceless();
std::unique_ptr<GlContext::Platform> open_egl_software_device();

/// The first library of the list that opens; throws with the loader's words when none does.
void* open_library(std::initializer_list<const char*> names);
/// A symbol of a library; throws when it is not there.
void* library_symbol(void* library, const char* name);

}  // namespace pliant
