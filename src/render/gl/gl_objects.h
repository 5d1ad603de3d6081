// Owners of GL objects. Their context must be current when they are constructed and destroyed.
#pragma once

#include "gl_functions.h"

namespace pliant::gl {

/// Owns one object, which Gen creates and Delete destroys.
template <void (*Functions::*Gen)(Size, Uint*), void (*Functions::*Delete)(Size, const Uint*)>
class Object {
 public:
  explicit Object(const Functions& gl) : gl_(gl) { (gl_.*Gen)(1, &name_); }
  ~Object() { (gl_.*Delete)(1, &name_); }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  Uint name() const { return name_; }

 private:
  const Functions& gl_;
  Uint name_ = 0;
};

using Buffer = Object<&Functions::gen_buffers, &Functions::delete_buffers>;
using VertexArray = Object<&Functions::gen_vertex_arrays, &Functions::delete_vertex_arrays>;
using Texture = Object<&Functions::gen_textures, &Functions::delete_textures>;
using Framebuffer = Object<&Functions::gen_framebuffers, &Functions::delete_framebuffers>;
using Renderbuffer = Object<&Functions::gen_renderbuffers, &Functions::delete_renderbuffers>;

/// A linked program in GLSL 330. Each stage begins with the shared text of shaders.h.
class Program {
 public:
  /// name: name of the program in messages. fragment_start: text that is placed before fragment_text. Throws
  /// std::runtime_error with the message of the GLSL compiler.
  Program(const Functions& gl, const char* name, const char* vertex_text, const char* fragment_text,
          const char* fragment_start = "");
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const { gl_.use_program(name_); }
  Int uniform(const char* name) const { return gl_.get_uniform_location(name_, name); }

 private:
  const Functions& gl_;
  Uint name_ = 0;
};

}  // namespace pliant::gl
