// The OpenGL entry points and constants that the renderer uses, declared by hand. GL headers and loader
// libraries are not used, because both fail under OSMesa.
#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/render/gl/gl_context.h>

namespace pliant::gl {

using Enum = unsigned;
using Uint = unsigned;
using Int = int;
using Size = int;
using Boolean = unsigned char;

inline constexpr Enum kTriangles = 0x0004, kTriangleStrip = 0x0005, kLessEqual = 0x0203,
                      kSourceAlpha = 0x0302, kOneMinusSourceAlpha = 0x0303, kFront = 0x0404, kBack = 0x0405,
                      kCullFace = 0x0B44, kDepthTest = 0x0B71, kBlend = 0x0BE2, kPackAlignment = 0x0D05,
                      kMaxTextureSize = 0x0D33, kTexture2d = 0x0DE1, kUnsignedByte = 0x1401,
                      kUnsignedInt = 0x1405, kFloat = 0x1406, kDepthComponent = 0x1902, kRed = 0x1903,
                      kRgba = 0x1908, kNearest = 0x2600, kLinear = 0x2601, kMagFilter = 0x2800,
                      kMinFilter = 0x2801, kWrapS = 0x2802, kWrapT = 0x2803, kRgba8 = 0x8058,
                      kClampToBorder = 0x812D, kClampToEdge = 0x812F, kDepthComponent16 = 0x81A5,
                      kDepthComponent24 = 0x81A6, kR8 = 0x8229, kTexture0 = 0x84C0, kDepthClamp = 0x864F,
                      kCompareMode = 0x884C, kCompareFunction = 0x884D, kCompareToReference = 0x884E,
                      kArrayBuffer = 0x8892, kElementArrayBuffer = 0x8893, kStreamDraw = 0x88E0,
                      kStaticDraw = 0x88E4, kUniformBuffer = 0x8A11, kFragmentShader = 0x8B30,
                      kVertexShader = 0x8B31, kCompileStatus = 0x8B81, kLinkStatus = 0x8B82,
                      kFramebufferComplete = 0x8CD5, kColorAttachment0 = 0x8CE0, kDepthAttachment = 0x8D00,
                      kFramebuffer = 0x8D40, kFrontAndBack = 0x0408, kLine = 0x1B01, kFill = 0x1B02,
                      kPolygonOffsetLine = 0x2A02, kRenderbuffer = 0x8D41, kBorderColor = 0x1004;
inline constexpr unsigned kDepthBufferBit = 0x0100;

// One line for each entry point: member, GL name, result, arguments.
#define PLIANT_GL_FUNCTIONS(X)                                                                         \
  X(active_texture, glActiveTexture, void, (Enum))                                                     \
  X(attach_shader, glAttachShader, void, (Uint, Uint))                                                 \
  X(bind_buffer, glBindBuffer, void, (Enum, Uint))                                                     \
  X(bind_buffer_base, glBindBufferBase, void, (Enum, Uint, Uint))                                      \
  X(bind_framebuffer, glBindFramebuffer, void, (Enum, Uint))                                           \
  X(bind_renderbuffer, glBindRenderbuffer, void, (Enum, Uint))                                         \
  X(bind_texture, glBindTexture, void, (Enum, Uint))                                                   \
  X(bind_vertex_array, glBindVertexArray, void, (Uint))                                                \
  X(blend_func, glBlendFunc, void, (Enum, Enum))                                                       \
  X(buffer_data, glBufferData, void, (Enum, std::ptrdiff_t, const void*, Enum))                        \
  X(check_framebuffer_status, glCheckFramebufferStatus, Enum, (Enum))                                  \
  X(clear, glClear, void, (unsigned))                                                                  \
  X(compile_shader, glCompileShader, void, (Uint))                                                     \
  X(create_program, glCreateProgram, Uint, ())                                                         \
  X(create_shader, glCreateShader, Uint, (Enum))                                                       \
  X(delete_buffers, glDeleteBuffers, void, (Size, const Uint*))                                        \
  X(delete_framebuffers, glDeleteFramebuffers, void, (Size, const Uint*))                              \
  X(delete_program, glDeleteProgram, void, (Uint))                                                     \
  X(delete_renderbuffers, glDeleteRenderbuffers, void, (Size, const Uint*))                            \
  X(delete_shader, glDeleteShader, void, (Uint))                                                       \
  X(delete_textures, glDeleteTextures, void, (Size, const Uint*))                                      \
  X(delete_vertex_arrays, glDeleteVertexArrays, void, (Size, const Uint*))                             \
  X(depth_func, glDepthFunc, void, (Enum))                                                             \
  X(depth_mask, glDepthMask, void, (Boolean))                                                          \
  X(disable, glDisable, void, (Enum))                                                                  \
  X(draw_arrays, glDrawArrays, void, (Enum, Int, Size))                                                \
  X(draw_arrays_instanced, glDrawArraysInstanced, void, (Enum, Int, Size, Size))                       \
  X(draw_buffer, glDrawBuffer, void, (Enum))                                                           \
  X(draw_elements, glDrawElements, void, (Enum, Size, Enum, const void*))                              \
  X(enable, glEnable, void, (Enum))                                                                    \
  X(enable_vertex_attrib_array, glEnableVertexAttribArray, void, (Uint))                               \
  X(framebuffer_renderbuffer, glFramebufferRenderbuffer, void, (Enum, Enum, Enum, Uint))               \
  X(framebuffer_texture_2d, glFramebufferTexture2D, void, (Enum, Enum, Enum, Uint, Int))               \
  X(gen_buffers, glGenBuffers, void, (Size, Uint*))                                                    \
  X(gen_framebuffers, glGenFramebuffers, void, (Size, Uint*))                                          \
  X(gen_renderbuffers, glGenRenderbuffers, void, (Size, Uint*))                                        \
  X(gen_textures, glGenTextures, void, (Size, Uint*))                                                  \
  X(gen_vertex_arrays, glGenVertexArrays, void, (Size, Uint*))                                         \
  X(get_error, glGetError, Enum, ())                                                                   \
  X(get_integer, glGetIntegerv, void, (Enum, Int*))                                                    \
  X(get_program, glGetProgramiv, void, (Uint, Enum, Int*))                                             \
  X(get_program_info_log, glGetProgramInfoLog, void, (Uint, Size, Size*, char*))                       \
  X(get_shader, glGetShaderiv, void, (Uint, Enum, Int*))                                               \
  X(get_shader_info_log, glGetShaderInfoLog, void, (Uint, Size, Size*, char*))                         \
  X(get_uniform_block_index, glGetUniformBlockIndex, Uint, (Uint, const char*))                        \
  X(get_uniform_location, glGetUniformLocation, Int, (Uint, const char*))                              \
  X(link_program, glLinkProgram, void, (Uint))                                                         \
  X(polygon_mode, glPolygonMode, void, (Enum, Enum))                                                   \
  X(polygon_offset, glPolygonOffset, void, (float, float))                                             \
  X(pixel_store, glPixelStorei, void, (Enum, Int))                                                     \
  X(read_buffer, glReadBuffer, void, (Enum))                                                           \
  X(read_pixels, glReadPixels, void, (Int, Int, Size, Size, Enum, Enum, void*))                        \
  X(renderbuffer_storage, glRenderbufferStorage, void, (Enum, Enum, Size, Size))                       \
  X(shader_source, glShaderSource, void, (Uint, Size, const char* const*, const Int*))                 \
  X(tex_image_2d, glTexImage2D, void, (Enum, Int, Int, Size, Size, Int, Enum, Enum, const void*))      \
  X(tex_parameter, glTexParameteri, void, (Enum, Enum, Int))                                           \
  X(tex_parameter_vector, glTexParameterfv, void, (Enum, Enum, const float*))                          \
  X(uniform_1f, glUniform1f, void, (Int, float))                                                       \
  X(uniform_1i, glUniform1i, void, (Int, Int))                                                         \
  X(uniform_3f, glUniform3f, void, (Int, float, float, float))                                         \
  X(uniform_3fv, glUniform3fv, void, (Int, Size, const float*))                                        \
  X(uniform_block_binding, glUniformBlockBinding, void, (Uint, Uint, Uint))                            \
  X(use_program, glUseProgram, void, (Uint))                                                           \
  X(vertex_attrib_divisor, glVertexAttribDivisor, void, (Uint, Uint))                                  \
  X(vertex_attrib_pointer, glVertexAttribPointer, void, (Uint, Int, Enum, Boolean, Size, const void*)) \
  X(viewport, glViewport, void, (Int, Int, Size, Size))

struct Functions {
  /// Looks up all entry points. Throws std::runtime_error, which names the entry point that the context does
  /// not have.
  explicit Functions(const GlContext& context);

#define PLIANT_GL_MEMBER(member, name, result, arguments) result(*member) arguments = nullptr;
  PLIANT_GL_FUNCTIONS(PLIANT_GL_MEMBER)
#undef PLIANT_GL_MEMBER
};

}  // namespace pliant::gl
