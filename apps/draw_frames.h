// Drawing the frames of a run. A missing graphics library is reported as ResourceFailure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <pliant/render/film.h>

namespace pliant_cli {

/// Opens a graphics context and closes it again. Returns a description of the context for run.json, for
/// example "OSMesa: llvmpipe, OpenGL 4.5". backend: graphics library; `automatic`: the first library that
/// opens. Throws ResourceFailure if no context opens.
std::string require_graphics(pliant::GlBackend backend);

/// Draws frames of a run as PNG files by pliant::render_frames(); pliant/render/film.h describes the
/// arguments. Throws ResourceFailure if no graphics context opens, and the exceptions of
/// pliant::render_frames().
void draw_frames(const std::filesystem::path& folder, const pliant::FilmSource& source, double frame_rate,
                 const std::vector<std::int64_t>& frames, pliant::Progress& progress,
                 pliant::GlBackend backend);

}  // namespace pliant_cli
