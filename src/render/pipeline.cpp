// Draws the passes of a picture. Opaque objects are drawn before the tracks, in the order bodies, ground,
// background. This order is roughly from front to back, so that each sample is shaded about once.
#include "pipeline.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <pliant/render/color_map.h>
#include <pliant/render/renderer.h>

#include "color_bar.h"
#include "render/gl/shaders.h"
#include "resolve.h"
#include "srgb.h"

namespace pliant {
namespace {

constexpr gl::Int kShadowUnit = 0, kContactUnit = 1, kSamplesUnit = 2;

Eigen::Vector3f linear(const Eigen::Vector3f& srgb) {
  return srgb.unaryExpr(&linear_light);
}

/// Returns the number of samples along a side of a picture, pixels.
int samples_along(int side, const PassSizes& sizes) {
  return std::max(1, static_cast<int>(std::lround(sizes.samples * side)));
}

template <class Things>
void check_colors(const Things& things, const char* kind) {
  for (std::size_t i = 0; i < things.size(); ++i)
    if (!((things[i].color.array() >= 0).all() && (things[i].color.array() <= 1).all()))
      throw std::invalid_argument(std::string("picture: the color of ") + kind + " " + std::to_string(i) +
                                  " must have channels in [0, 1]");
}

}  // namespace

MapTarget::MapTarget(const gl::Functions& gl, gl::Enum format, int side) : texture(gl), framebuffer(gl) {
  const bool depth = format != gl::kR8;
  gl.bind_texture(gl::kTexture2d, texture.name());
  gl.tex_image_2d(gl::kTexture2d, 0, static_cast<gl::Int>(format), side, side, 0,
                  depth ? gl::kDepthComponent : gl::kRed, depth ? gl::kFloat : gl::kUnsignedByte, nullptr);
  gl.tex_parameter(gl::kTexture2d, gl::kMinFilter, depth ? gl::kNearest : gl::kLinear);
  gl.tex_parameter(gl::kTexture2d, gl::kMagFilter, depth ? gl::kNearest : gl::kLinear);
  gl.tex_parameter(gl::kTexture2d, gl::kWrapS, gl::kClampToBorder);
  gl.tex_parameter(gl::kTexture2d, gl::kWrapT, gl::kClampToBorder);
  const float border[4] = {1, 1, 1, 1};
  gl.tex_parameter_vector(gl::kTexture2d, gl::kBorderColor, border);
  gl.bind_framebuffer(gl::kFramebuffer, framebuffer.name());
  gl.framebuffer_texture_2d(gl::kFramebuffer, depth ? gl::kDepthAttachment : gl::kColorAttachment0,
                            gl::kTexture2d, texture.name(), 0);
  if (depth) {
    gl.draw_buffer(0);
    gl.read_buffer(0);
  }
}

PassSizes pass_sizes(int width, int height) {
  const auto check = [](int side, const char* name) {
    if (side < 1 || side > Renderer::kMaxSide)
      throw std::invalid_argument(std::string("picture: the ") + name + " of " + std::to_string(side) +
                                  " pixels is not in [1, " + std::to_string(Renderer::kMaxSide) + "]");
  };
  check(width, "width");
  check(height, "height");
  PassSizes sizes;
  sizes.width = width;
  sizes.height = height;
  return sizes;
}

Pipeline::Pipeline(const GlContext& context, const PassSizes& sizes)
    : gl_(context),
      sizes_(sizes),
      samples_wide_(samples_along(sizes.width, sizes)),
      samples_high_(samples_along(sizes.height, sizes)),
      shadow_program_(gl_, "shadow", shaders::kShadowVertex, shaders::kDepthFragment),
      height_program_(gl_, "height", shaders::kHeightVertex, shaders::kDepthFragment),
      contact_program_(gl_, "contact", shaders::kContactVertex, shaders::kContactFragment),
      body_program_(gl_, "body", shaders::kBodyVertex, shaders::kBodyFragment, shaders::kOwnColor),
      ground_program_(gl_, "ground", shaders::kGroundVertex, shaders::kGroundFragment),
      background_program_(gl_, "background", shaders::kBackgroundVertex, shaders::kBackgroundFragment),
      track_program_(gl_, "track", shaders::kTrackVertex, shaders::kTrackFragment),
      shadow_(gl_, gl::kDepthComponent24, sizes.shadow_side),
      heights_(gl_, gl::kDepthComponent16, sizes.contact_side),
      contact_(gl_, gl::kR8, sizes.contact_side),
      target_(gl_),
      color_(gl_),
      depth_(gl_),
      frame_buffer_(gl_),
      empty_(gl_),
      meshes_(gl_),
      tracks_(gl_) {
  // Depth comparisons with the shadow map are filtered over the four nearest texels.
  gl_.bind_texture(gl::kTexture2d, shadow_.texture.name());
  gl_.tex_parameter(gl::kTexture2d, gl::kCompareMode, gl::kCompareToReference);
  gl_.tex_parameter(gl::kTexture2d, gl::kCompareFunction, gl::kLessEqual);
  gl_.tex_parameter(gl::kTexture2d, gl::kMinFilter, gl::kLinear);
  gl_.tex_parameter(gl::kTexture2d, gl::kMagFilter, gl::kLinear);

  check_target();
  for (const gl::Program* program : {&body_program_, &ground_program_}) {
    program->use();
    gl_.uniform_1i(program->uniform("shadow_map"), kShadowUnit);
  }
  gl_.uniform_1i(ground_program_.uniform("contact_map"), kContactUnit);
  contact_program_.use();
  gl_.uniform_1i(contact_program_.uniform("heights"), kContactUnit);
  gl_.enable(gl::kCullFace);
  gl_.depth_func(gl::kLessEqual);
  gl_.blend_func(gl::kSourceAlpha, gl::kOneMinusSourceAlpha);
}

void Pipeline::check_target() {
  gl::Int largest = 0;
  gl_.get_integer(gl::kMaxTextureSize, &largest);
  const std::string size = std::to_string(sizes_.width) + " x " + std::to_string(sizes_.height);
  if (samples_wide_ > largest || samples_high_ > largest)
    throw std::runtime_error("a picture of " + size +
                             " pixels is too large for this OpenGL; the largest side is " +
                             std::to_string(static_cast<int>(largest / sizes_.samples)) + " pixels");
  gl_.bind_texture(gl::kTexture2d, color_.name());
  gl_.tex_image_2d(gl::kTexture2d, 0, static_cast<gl::Int>(gl::kRgba8), samples_wide_, samples_high_, 0,
                   gl::kRgba, gl::kUnsignedByte, nullptr);
  gl_.tex_parameter(gl::kTexture2d, gl::kMinFilter, gl::kLinear);
  gl_.tex_parameter(gl::kTexture2d, gl::kMagFilter, gl::kLinear);
  gl_.tex_parameter(gl::kTexture2d, gl::kWrapS, gl::kClampToEdge);
  gl_.tex_parameter(gl::kTexture2d, gl::kWrapT, gl::kClampToEdge);
  gl_.bind_renderbuffer(gl::kRenderbuffer, depth_.name());
  gl_.renderbuffer_storage(gl::kRenderbuffer, gl::kDepthComponent24, samples_wide_, samples_high_);
  gl_.bind_framebuffer(gl::kFramebuffer, target_.name());
  gl_.framebuffer_texture_2d(gl::kFramebuffer, gl::kColorAttachment0, gl::kTexture2d, color_.name(), 0);
  gl_.framebuffer_renderbuffer(gl::kFramebuffer, gl::kDepthAttachment, gl::kRenderbuffer, depth_.name());
  for (const gl::Uint framebuffer : {target_.name(), shadow_.framebuffer.name(), heights_.framebuffer.name(),
                                     contact_.framebuffer.name()}) {
    gl_.bind_framebuffer(gl::kFramebuffer, framebuffer);
    if (gl_.get_error() != 0 || gl_.check_framebuffer_status(gl::kFramebuffer) != gl::kFramebufferComplete)
      throw std::runtime_error("this OpenGL cannot allocate a picture of " + size +
                               " pixels; choose a smaller size");
  }
}

void Pipeline::draw_depth(const MapTarget& map, int side, const gl::Program& program, bool bodies) {
  gl_.bind_framebuffer(gl::kFramebuffer, map.framebuffer.name());
  gl_.viewport(0, 0, side, side);
  gl_.clear(gl::kDepthBufferBit);
  if (!bodies || meshes_.index_count() == 0) return;
  program.use();
  meshes_.bind();
  gl_.draw_elements(gl::kTriangles, meshes_.index_count(), gl::kUnsignedInt, nullptr);
}

void Pipeline::draw_triangle() {
  gl_.bind_vertex_array(empty_.name());
  gl_.draw_arrays(gl::kTriangles, 0, 3);
}

void Pipeline::draw_contact(bool bodies) {
  gl_.active_texture(gl::kTexture0 + kContactUnit);
  gl_.enable(gl::kDepthClamp);
  draw_depth(heights_, sizes_.contact_side, height_program_, bodies);
  gl_.disable(gl::kDepthClamp);
  gl_.disable(gl::kDepthTest);
  gl_.bind_framebuffer(gl::kFramebuffer, contact_.framebuffer.name());
  gl_.bind_texture(gl::kTexture2d, heights_.texture.name());
  contact_program_.use();
  draw_triangle();
  gl_.bind_texture(gl::kTexture2d, contact_.texture.name());
  gl_.enable(gl::kDepthTest);
}

void Pipeline::draw_bodies(const Picture& picture) {
  if (meshes_.index_count() == 0) return;
  const auto leveled = [&](const Picture::Body& body) { return picture.scale && body.values != nullptr; };
  body_program_.use();
  meshes_.bind();
  const gl::Int own_color = body_program_.uniform("own_color");
  for (std::size_t i = 0; i < picture.bodies.size(); ++i) {
    if (leveled(picture.bodies[i])) continue;
    const Eigen::Vector3f color = linear(picture.bodies[i].color);
    gl_.uniform_3f(own_color, color[0], color[1], color[2]);
    draw_body(i);
  }
  if (std::none_of(picture.bodies.begin(), picture.bodies.end(), leveled)) return;
  if (!leveled_program_) {
    leveled_program_ = std::make_unique<gl::Program>(gl_, "leveled body", shaders::kLeveledVertex,
                                                     shaders::kBodyFragment, shaders::kLevelColor);
    leveled_program_->use();
    gl_.uniform_1i(leveled_program_->uniform("shadow_map"), kShadowUnit);
    gl_.uniform_3fv(leveled_program_->uniform("color_map"), kMapColors, color_map().front().data());
  }
  leveled_program_->use();
  meshes_.bind_levels();
  for (std::size_t i = 0; i < picture.bodies.size(); ++i)
    if (leveled(picture.bodies[i])) draw_body(i);
}

// Draws the edges of all triangles, slightly nearer to the eye than the surfaces.
void Pipeline::draw_edges() {
  if (meshes_.index_count() == 0) return;
  constexpr float kNearer = -1;  // both arguments of glPolygonOffset: factor of the slope, units of depth
  body_program_.use();
  gl_.uniform_3f(body_program_.uniform("own_color"), 0.02f, 0.02f, 0.03f);
  meshes_.bind();
  gl_.polygon_mode(gl::kFrontAndBack, gl::kLine);
  gl_.polygon_offset(kNearer, kNearer);
  gl_.enable(gl::kPolygonOffsetLine);
  gl_.draw_elements(gl::kTriangles, meshes_.index_count(), gl::kUnsignedInt, nullptr);
  gl_.disable(gl::kPolygonOffsetLine);
  gl_.polygon_mode(gl::kFrontAndBack, gl::kFill);
}

void Pipeline::draw_body(std::size_t body) {
  const MeshBatch::Range& range = meshes_.ranges()[body];
  gl_.draw_elements(
      gl::kTriangles, range.count, gl::kUnsignedInt,
      reinterpret_cast<const void*>(static_cast<std::size_t>(range.first) * sizeof(std::uint32_t)));
}

void Pipeline::draw_tracks(const Picture& picture) {
  if (picture.tracks.empty()) return;
  track_program_.use();
  gl_.enable(gl::kBlend);
  gl_.depth_mask(0);
  for (std::size_t i = 0; i < picture.tracks.size(); ++i) {
    const TrackBatch::Range& range = tracks_.ranges()[i];
    const Eigen::Vector3f color = linear(picture.tracks[i].color);
    if (range.segments == 0) continue;
    gl_.uniform_3f(track_program_.uniform("color"), color[0], color[1], color[2]);
    gl_.uniform_1f(track_program_.uniform("half_width"),
                   0.5f * static_cast<float>(sizes_.samples) * picture.tracks[i].width);
    tracks_.bind(range);
    if (picture.tracks[i].on_top) gl_.disable(gl::kDepthTest);
    gl_.draw_arrays_instanced(gl::kTriangleStrip, 0, 4, range.segments);
    gl_.enable(gl::kDepthTest);
  }
  gl_.depth_mask(1);
  gl_.disable(gl::kBlend);
}

void Pipeline::draw_samples(const Picture& picture) {
  check_colors(picture.bodies, "body");
  check_colors(picture.tracks, "track");
  if (picture.scale &&
      !(std::isfinite(picture.scale->high - picture.scale->low) && picture.scale->low < picture.scale->high))
    throw std::invalid_argument("picture: the scale of values must go from a finite number to a larger one");
  meshes_.update(picture);
  const FrameBlock frame = frame_block(picture, meshes_.boxes(), sizes_);
  tracks_.update(picture, frame);
  gl_.bind_buffer(gl::kUniformBuffer, frame_buffer_.name());
  gl_.buffer_data(gl::kUniformBuffer, sizeof frame, &frame, gl::kStreamDraw);
  gl_.bind_buffer_base(gl::kUniformBuffer, shaders::kFrameBinding, frame_buffer_.name());

  gl_.enable(gl::kDepthTest);
  gl_.enable(gl::kDepthClamp);
  draw_depth(shadow_, sizes_.shadow_side, shadow_program_, picture.lights.shadows);
  gl_.disable(gl::kDepthClamp);
  if (picture.ground.shown) draw_contact(picture.lights.shadows && sizes_.occlusion);

  gl_.active_texture(gl::kTexture0 + kShadowUnit);
  gl_.bind_texture(gl::kTexture2d, shadow_.texture.name());
  gl_.bind_framebuffer(gl::kFramebuffer, target_.name());
  gl_.viewport(0, 0, samples_wide_, samples_high_);
  gl_.clear(gl::kDepthBufferBit);
  draw_bodies(picture);
  if (picture.edges) draw_edges();
  gl_.bind_vertex_array(empty_.name());
  if (picture.ground.shown) {
    ground_program_.use();
    gl_.draw_arrays(gl::kTriangleStrip, 0, 4);
  }
  background_program_.use();
  draw_triangle();
  draw_tracks(picture);
}

void Pipeline::check_errors() {
  if (const gl::Enum error = gl_.get_error())
    throw std::runtime_error("OpenGL failed to draw a picture (error " + std::to_string(error) + ")");
}

void Pipeline::draw_to_window(const Picture& picture) {
  draw_samples(picture);
  present();
}

void Pipeline::present() {
  if (!present_program_) {
    present_program_ =
        std::make_unique<gl::Program>(gl_, "present", shaders::kBackgroundVertex, shaders::kPresentFragment);
    present_program_->use();
    gl_.uniform_1i(present_program_->uniform("samples"), kSamplesUnit);
  }
  gl_.bind_framebuffer(gl::kFramebuffer, 0);
  gl_.viewport(0, 0, sizes_.width, sizes_.height);
  gl_.disable(gl::kDepthTest);
  gl_.active_texture(gl::kTexture0 + kSamplesUnit);
  gl_.bind_texture(gl::kTexture2d, color_.name());
  gl_.bind_buffer_base(gl::kUniformBuffer, shaders::kFrameBinding, frame_buffer_.name());
  present_program_->use();
  draw_triangle();
  check_errors();
}

Image Pipeline::draw(const Picture& picture) {
  draw_samples(picture);
  samples_.resize(static_cast<std::size_t>(samples_wide_) * static_cast<std::size_t>(samples_high_) * 4);
  gl_.pixel_store(gl::kPackAlignment, 4);
  gl_.read_pixels(0, 0, samples_wide_, samples_high_, gl::kRgba, gl::kUnsignedByte, samples_.data());
  check_errors();
  Image image = resolve(samples_, sizes_.width, sizes_.height);
  if (picture.scale) draw_color_bar(image, *picture.scale);
  return image;
}

}  // namespace pliant
