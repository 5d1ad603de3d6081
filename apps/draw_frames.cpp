#include "draw_frames.h"

#include <system_error>

#include "failure.h"

namespace pliant_cli {

void draw_frames(const std::filesystem::path& folder, const pliant::Scene& scene, const pliant::Model& model,
                 const pliant::Recording& recording, double frame_rate,
                 const std::vector<std::int64_t>& frames, pliant::Progress& progress,
                 pliant::GlBackend backend) {
  try {
    const pliant::GlContext probe(backend);
  } catch (const std::runtime_error& error) {
    throw ResourceFailure(error.what());
  }
  pliant::render_frames(folder, scene, model, recording, frame_rate, frames, progress, backend);
}

}  // namespace pliant_cli
