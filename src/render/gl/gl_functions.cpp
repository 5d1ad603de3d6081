// Loads the table of entry points from a context.
#include "gl_functions.h"

#include <stdexcept>

namespace pliant::gl {

Functions::Functions(const GlContext& context) {
  const auto find = [&](const char* name) {
    if (void* address = context.function(name)) return address;
    throw std::runtime_error(context.backend() + " (" + context.version() + ") has no function " + name);
  };
#define PLIANT_GL_LOAD(member, name, result, arguments) \
  member = reinterpret_cast<decltype(member)>(find(#name));
  PLIANT_GL_FUNCTIONS(PLIANT_GL_LOAD)
#undef PLIANT_GL_LOAD
}

}  // namespace pliant::gl
