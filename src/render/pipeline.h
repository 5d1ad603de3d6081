// The passes of a picture: shadow map, contact map, and then bodies, ground, background and tracks with
// several samples for each pixel. The samples become an image, or the pixels of a window.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <pliant/io/format/image.h>
#include <pliant/render/picture.h>

#include "frame_block.h"
#include "mesh_batch.h"
#include "render/gl/gl_objects.h"
#include "tracks.h"

namespace pliant {

/// A square texture into which a pass draws depths of bodies, or shares of the visible sky.
struct MapTarget {
  MapTarget(const gl::Functions& gl, gl::Enum format, int side);
  gl::Texture texture;
  gl::Framebuffer framebuffer;
};

/// Returns the sizes of the passes for a picture of full quality. width, height: pixels. Throws
/// std::invalid_argument unless both are in [1, Renderer::kMaxSide].
PassSizes pass_sizes(int width, int height);

/// Draws pictures of one size. The context must be current during all calls and the destructor. Members that
/// draw throw std::invalid_argument for a setting of the picture that is out of range, and std::runtime_error
/// if OpenGL fails.
class Pipeline {
 public:
  Pipeline(const GlContext& context, const PassSizes& sizes);
  /// Returns the image of a picture. PassSizes::samples must be 2.
  Image draw(const Picture& picture);
  /// Draws a picture, without its colour bar, into the lower left corner of framebuffer 0, the framebuffer of
  /// the window.
  void draw_to_window(const Picture& picture);
  /// Copies the pixels of the last picture to the window again.
  void present();

 private:
  void draw_samples(const Picture& picture);
  void draw_depth(const MapTarget& map, int side, const gl::Program& program, bool bodies);
  void draw_contact(bool bodies);
  void draw_bodies(const Picture& picture);
  void draw_body(std::size_t body);
  void draw_edges();
  void draw_tracks(const Picture& picture);
  void draw_triangle();
  void check_target();
  void check_errors();

  gl::Functions gl_;
  PassSizes sizes_;
  int samples_wide_, samples_high_;
  gl::Program shadow_program_, height_program_, contact_program_, body_program_, ground_program_,
      background_program_, track_program_;
  std::unique_ptr<gl::Program> leveled_program_;  // for bodies coloured by values; created at the first use
  std::unique_ptr<gl::Program> present_program_;  // for windows; created at the first use
  MapTarget shadow_, heights_, contact_;
  gl::Framebuffer target_;
  gl::Texture color_;
  gl::Renderbuffer depth_;
  gl::Buffer frame_buffer_;
  gl::VertexArray empty_;
  MeshBatch meshes_;
  TrackBatch tracks_;
  std::vector<std::uint8_t> samples_;
};

}  // namespace pliant
