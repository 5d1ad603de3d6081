// The passes of a picture: shadow map, contact map, and then bodies, ground, background and tracks with 2 x 2
// samples for each pixel.
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

/// Draws pictures of one size. The context must be current during all calls and the destructor.
class Pipeline {
 public:
  Pipeline(const GlContext& context, int width, int height);
  /// Returns the image of a picture. Throws std::invalid_argument for a setting of the picture that is out of
  /// range, std::runtime_error if OpenGL fails.
  Image draw(const Picture& picture);

 private:
  void draw_depth(const MapTarget& map, int side, const gl::Program& program, bool bodies);
  void draw_contact(bool bodies);
  void draw_bodies(const Picture& picture);
  void draw_body(std::size_t body);
  void draw_tracks(const Picture& picture);
  void draw_triangle();
  void check_target();

  gl::Functions gl_;
  int width_, height_;
  gl::Program shadow_program_, height_program_, contact_program_, body_program_, ground_program_,
      background_program_, track_program_;
  std::unique_ptr<gl::Program> leveled_program_;  // for bodies coloured by values; created at the first use
  MapTarget shadow_, heights_, contact_;
  gl::Framebuffer target_;
  gl::Renderbuffer color_, depth_;
  gl::Buffer frame_buffer_;
  gl::VertexArray empty_;
  MeshBatch meshes_;
  TrackBatch tracks_;
  std::vector<std::uint8_t> samples_;
};

}  // namespace pliant
