// Draws pictures without a window. Equal input gives equal bytes for every backend and any number of
// rasteriser threads.
#pragma once

#include <memory>
#include <string>

#include <pliant/io/format/image.h>
#include <pliant/render/gl/gl_context.h>
#include <pliant/render/picture.h>

namespace pliant {

/// Throws OutOfMemory, with the needed memory and the limit, if this process cannot have the memory that
/// drawing a picture of this size needs. Call this function before a GL library is loaded. width, height:
/// pixels.
void require_picture_memory(int width, int height);

/// Draws pictures of one size. The renderer keeps its GL buffers between frames: if a body has the same
/// triangles as in the previous frame, only its vertices are sent to GL. One thread at a time may draw with a
/// renderer. Any number of renderers may exist.
class Renderer {
 public:
  static constexpr int kMaxSide = 8192;  ///< pixels

  /// Opens a GL library. No GL library is loaded before the first renderer or context is constructed, or
  /// probe_gl_backends() is called. width, height: pixels. Throws std::invalid_argument unless both are in
  /// [1, kMaxSide], and std::runtime_error if no backend opens or if OpenGL cannot draw a picture of this
  /// size.
  Renderer(int width, int height, GlBackend backend = GlBackend::automatic);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws a picture and returns the image. Throws std::invalid_argument, which names the body, track or
  /// setting that is missing, out of range or not finite, and std::runtime_error if GL fails.
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
