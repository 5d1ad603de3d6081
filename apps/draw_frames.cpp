// Drawing the frames of a run. A graphics context is opened before drawing, so that a missing graphics
// library is reported with its own exit code.
#include "draw_frames.h"

#include <stdexcept>

#include "failure.h"

namespace pliant_cli {

std::string require_graphics(pliant::GlBackend backend) {
  try {
    const pliant::GlContext probe(backend);
    return probe.backend() + ": " + probe.renderer() + ", OpenGL " + probe.version();
  } catch (const std::runtime_error& error) {
    throw ResourceFailure(error.what());
  }
}

void draw_frames(const std::filesystem::path& folder, const pliant::FilmSource& source, double frame_rate,
                 const std::vector<std::int64_t>& frames, pliant::Progress& progress,
                 pliant::GlBackend backend) {
  require_graphics(backend);
  pliant::render_frames(folder, source, frame_rate, frames, progress, backend);
}

}  // namespace pliant_cli
