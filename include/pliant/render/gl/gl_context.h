// An OpenGL 3.3 core context without a window. Two libraries can give one, both opened at run time and only
// when a context is asked for: OSMesa (Mesa before 25.1) and EGL (without a surface, or on Mesa's software
// device).
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace pliant {

enum class GlBackend {
  automatic,  ///< OSMesa if it opens, else EGL
  osmesa,
  egl,  ///< EGL without a surface if it opens, else EGL's software device
};

class GlContext {
 public:
  /// Throws std::runtime_error that says what was tried, why each failed and which packages help.
  explicit GlContext(GlBackend backend = GlBackend::automatic);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// While it lives, GL calls of this thread go to the context. One context may serve several threads in
  /// turn.
  class Current {
   public:
    explicit Current(GlContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    GlContext& context_;
  };

  /// Address of a GL entry point, nullptr when there is none of that name.
  void* function(const char* name) const;
  /// "OSMesa", "EGL surfaceless" or "EGL software device".
  const std::string& backend() const { return backend_; }
  const std::string& renderer() const { return renderer_; }  ///< GL_RENDERER
  const std::string& version() const { return version_; }    ///< GL_VERSION

  struct Platform;

 private:
  std::unique_ptr<Platform> platform_;
  std::string backend_, renderer_, version_;
};

/// One way to a context and what became of it.
struct GlProbe {
  std::string name;  ///< as GlContext::backend()
  bool opened = false;
  std::string reason;    ///< why it did not open, else empty
  std::string renderer;  ///< GL_RENDERER
  std::string version;   ///< GL_VERSION
};

/// Tries every way in the order of GlBackend::automatic. Opens the libraries; never throws for a missing one.
std::vector<GlProbe> probe_gl_backends();

}  // namespace pliant
