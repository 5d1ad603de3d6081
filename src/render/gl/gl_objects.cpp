// Compilation and linking of programs.
#include "gl_objects.h"

#include <array>
#include <stdexcept>
#include <string>

#include "shaders.h"

namespace pliant::gl {
namespace {

Uint compile(const Functions& gl, Enum stage, const char* name, const char* start, const char* text) {
  const Uint shader = gl.create_shader(stage);
  const std::array<const char*, 3> parts = {shaders::kShared, start, text};
  gl.shader_source(shader, static_cast<Size>(parts.size()), parts.data(), nullptr);
  gl.compile_shader(shader);
  Int good = 0;
  gl.get_shader(shader, kCompileStatus, &good);
  if (good) return shader;
  std::array<char, 2000> log{};
  gl.get_shader_info_log(shader, static_cast<Size>(log.size()), nullptr, log.data());
  gl.delete_shader(shader);
  throw std::runtime_error(std::string("shader ") + name +
                           " does not compile with this OpenGL: " + log.data());
}

}  // namespace

Program::Program(const Functions& gl, const char* name, const char* vertex_text, const char* fragment_text,
                 const char* fragment_start)
    : gl_(gl) {
  const Uint vertex = compile(gl, kVertexShader, name, "", vertex_text);
  Uint fragment = 0;
  try {
    fragment = compile(gl, kFragmentShader, name, fragment_start, fragment_text);
  } catch (...) {
    gl.delete_shader(vertex);
    throw;
  }
  name_ = gl.create_program();
  gl.attach_shader(name_, vertex);
  gl.attach_shader(name_, fragment);
  gl.link_program(name_);
  gl.delete_shader(vertex);
  gl.delete_shader(fragment);
  Int good = 0;
  gl.get_program(name_, kLinkStatus, &good);
  if (!good) {
    std::array<char, 2000> log{};
    gl.get_program_info_log(name_, static_cast<Size>(log.size()), nullptr, log.data());
    gl.delete_program(name_);
    throw std::runtime_error(std::string("shader ") + name +
                             " does not link with this OpenGL: " + log.data());
  }
  const Uint block = gl.get_uniform_block_index(name_, "Frame");
  if (block != ~0u) gl.uniform_block_binding(name_, block, shaders::kFrameBinding);
}

Program::~Program() {
  gl_.delete_program(name_);
}

}  // namespace pliant::gl
