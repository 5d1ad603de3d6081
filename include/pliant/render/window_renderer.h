// Draws pictures in the window of another library, with the passes of Renderer.
#pragma once

#include <memory>
#include <string>

#include <pliant/io/format/image.h>
#include <pliant/render/gl/gl_context.h>
#include <pliant/render/picture.h>

namespace pliant {

/// The context of the window must be current on the calling thread during all calls.
class WindowRenderer {
 public:
  enum class Quality {
    /// One sample for each pixel, a coarse shadow map and no occlusion of the sky, for pictures that change.
    draft,
    full  ///< the quality of Renderer
  };

  /// loader: finds the GL entry points of the context. Throws std::runtime_error if the context is not OpenGL
  /// 3.3 or later.
  explicit WindowRenderer(GlContext::Loader loader);
  ~WindowRenderer();
  WindowRenderer(const WindowRenderer&) = delete;
  WindowRenderer& operator=(const WindowRenderer&) = delete;

  /// Draws a picture into the whole window, without its colour bar. width, height: size of the window,
  /// pixels. Throws what Renderer and Renderer::draw() throw.
  void draw(const Picture& picture, int width, int height, Quality quality);
  /// Shows the last picture again, without drawing it. Does nothing before the first picture.
  void draw_again();
  /// Returns the pixels of the window. width, height: size of the window, pixels.
  Image read(int width, int height);

  const std::string& device() const;  ///< GL_RENDERER

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pliant
