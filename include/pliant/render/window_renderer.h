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
  /// Drafts are for pictures that change: they have a coarse shadow map, coarser with fewer samples, and no
  /// occlusion of the sky.
  enum class Quality {
    half_draft,        ///< a sample for 2 x 2 pixels
    two_thirds_draft,  ///< 2 x 2 samples for 3 x 3 pixels
    draft,             ///< a sample for each pixel
    full               ///< the quality of Renderer
  };
  static constexpr int kQualities = 4;
  /// Returns the number of samples along the side of a pixel.
  static constexpr double samples(Quality quality) {
    constexpr double of[kQualities] = {1.0 / 2, 2.0 / 3, 1, 2};
    return of[static_cast<int>(quality)];
  }

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
