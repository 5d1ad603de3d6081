// Drawing a run's frames from the program: a missing graphics library becomes a failure of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <pliant/render/film.h>

namespace pliant_cli {

/// Opens a graphics library and closes it again. Throws ResourceFailure when none opens; returns the words
/// for run.json, as "OSMesa: llvmpipe".
std::string require_graphics(pliant::GlBackend backend);

/// As pliant::render_frames; throws ResourceFailure when no graphics library opens.
void draw_frames(const std::filesystem::path& folder, const pliant::Scene& scene, const pliant::Model& model,
                 const pliant::Recording& recording, double frame_rate,
                 const std::vector<std::int64_t>& frames, pliant::Progress& progress,
                 pliant::GlBackend backend);

}  // namespace pliant_cli
