// Drawing the frames of a run. A missing graphics library is reported as ResourceFailure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <pliant/render/film.h>

namespace pliant_cli {

/// Opens a context and closes it again. Returns its description for run.json, for example "OSMesa: llvmpipe,
/// OpenGL 4.5". Throws ResourceFailure if none opens.
std::string require_graphics(pliant::GlBackend backend);

/// Calls pliant::render_frames. Throws ResourceFailure if no graphics library opens.
void draw_frames(const std::filesystem::path& folder, const pliant::FilmSource& source, double frame_rate,
                 const std::vector<std::int64_t>& frames, pliant::Progress& progress,
                 pliant::GlBackend backend);

}  // namespace pliant_cli
