// Draws pictures without a window. The same input gives the same bytes, whichever backend draws and with any
// number of raster threads.
#pragma once

#include <memory>
#include <string>

#include <pliant/io/format/image.h>
#include <pliant/render/gl/gl_context.h>
#include <pliant/render/picture.h>

namespace pliant {

/// Keeps its GL buffers between frames: bodies whose triangles are those of the frame before only send their
/// vertices. One thread at a time may draw with a renderer; any number of renderers may exist.
class Renderer {
 public:
  static constexpr int kMaxSide = 8192;  ///< pixels

  /// Opens a GL library (the first moment one is loaded). Throws std::invalid_argument unless both sides are
  /// in [1, kMaxSide], std::runtime_error when no backend opens or it cannot hold a picture of that size.
  Renderer(int width, int height, GlBackend backend = GlBackend::automatic);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Throws std::invalid_argument that names the body, track or setting which is missing, out of range or not
  /// finite, std::runtime_error when GL fails.
  Image draw(const Picture& picture);

  int width() const;
  int height() const;
  const std::string& backend() const;  ///< "OSMesa", "EGL surfaceless" or "EGL software device"
  const std::string& device() const;   ///< GL_RENDERER

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pliant
