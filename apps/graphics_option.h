// The option --gl: which graphics library draws the pictures.
#pragma once

#include <map>
#include <string>

#include <CLI/CLI.hpp>

#include <pliant/render/gl/gl_context.h>

namespace pliant_cli {

/// Declares --gl, which sets `backend`.
void add_graphics_option(CLI::App& command, pliant::GlBackend& backend);

}  // namespace pliant_cli
