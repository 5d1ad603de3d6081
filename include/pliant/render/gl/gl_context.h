// An OpenGL 3.3 core context. Two libraries can provide a context without a window: OSMesa (Mesa before 25.1)
// and EGL (without a surface, or on Mesa's software device). These libraries are opened at run time, when a
// context is requested. The program that opens a window provides the context of the window.
#pragma once

#include <functional>
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
  /// Opens a context. Throws std::runtime_error, which lists the backends that were tried, the reason of
  /// each failure and the packages to install.
  explicit GlContext(GlBackend backend = GlBackend::automatic);
  /// Returns the address of a GL entry point of the current context; nullptr if no entry point has this name.
  using Loader = std::function<void*(const char* name)>;
  /// Uses the context of a window, which the caller has made current and keeps current on this thread. Throws
  /// std::runtime_error if the context does not work.
  explicit GlContext(Loader loader);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes the context current on this thread for its lifetime. Several threads may use one context in turn.
  class Current {
   public:
    explicit Current(GlContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    GlContext& context_;
  };

  /// Returns the address of a GL entry point; nullptr if no entry point has this name.
  void* function(const char* name) const;
  /// Returns "OSMesa", "EGL surfaceless", "EGL software device" or "window".
  const std::string& backend() const { return backend_; }
  const std::string& renderer() const { return renderer_; }  ///< GL_RENDERER
  const std::string& version() const { return version_; }    ///< GL_VERSION

  struct Platform;

 private:
  std::unique_ptr<Platform> platform_;
  std::string backend_, renderer_, version_;
};

/// One backend and the result of opening it.
struct GlProbe {
  std::string name;  ///< see GlContext::backend()
  bool opened = false;
  std::string reason;    ///< reason of the failure; empty if the backend opened
  std::string renderer;  ///< GL_RENDERER
  std::string version;   ///< GL_VERSION
};

/// Tries every backend in the order of GlBackend::automatic and returns one result per backend. Opens the
/// libraries; a missing library is no error.
std::vector<GlProbe> probe_gl_backends();

}  // namespace pliant
