// The interface of a backend of GlContext. The libraries stay loaded until the process ends, because Mesa's
// threads and exit handlers fail after dlclose.
#pragma once

#include <memory>

#include <pliant/render/gl/gl_context.h>

namespace pliant {

struct GlContext::Platform {
  virtual ~Platform() = default;
  virtual void make_current() = 0;  ///< throws std::runtime_error if the call fails
  virtual void release() = 0;
  virtual void* function(const char* name) const = 0;
};

// Each function opens a context, or throws std::runtime_error with the reason of the failure.
std::unique_ptr<GlContext::Platform> open_osmesa();
std::unique_ptr<GlContext::Platform> open_egl_surfaceless();
std::unique_ptr<GlContext::Platform> open_egl_software_device();
/// Returns the platform of a context that stays current on the calling thread.
std::unique_ptr<GlContext::Platform> use_current_context(GlContext::Loader loader);

/// Opens the first library of the list that can be loaded. Throws std::runtime_error with the messages of the
/// loader if no library can be loaded.
void* open_library(std::initializer_list<const char*> names);
/// Returns the address of a symbol of a library. Throws std::runtime_error if the library has no such symbol.
void* library_symbol(void* library, const char* name);

}  // namespace pliant
