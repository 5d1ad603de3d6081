// The pictures of a run's frames, drawn from its recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <pliant/body/placed_point.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/render/picture.h>
#include <pliant/render/renderer.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// Makes the picture of any frame: the parts, the tracks up to then, and springs, rods and strings as thin
/// lines, which end in a dot where they hold on to the world. Camera, ground and the scale of values are the
/// same in all frames of a run: where the scene leaves them open, they follow from the whole recorded motion.
class Film {
 public:
  /// All must outlive the film. Throws RecordingMismatch, std::out_of_range when nothing is recorded.
  Film(const Scene& scene, const Model& model, const Recording& recording);

  /// The picture at a time (s); valid until the next call.
  const Picture& at(double time);
  const Camera& camera() const { return picture_.camera; }

 private:
  struct Tie {
    std::vector<PlacedPoint> ends;  ///< one, of a joint that ties no other point, or two
    bool line;
    const Joint* joint;  ///< nullptr for a spring
  };
  void lay_tracks();
  void lay_ties();
  Eigen::AlignedBox3d anchors(const Eigen::AlignedBox3d& bodies) const;
  void draw_ties(const State& state);
  void choose_view();
  void choose_scale();

  const Scene* scene_;
  const Model* model_;
  const Recording* recording_;
  FrameMeshes meshes_;
  std::vector<PlacedPoint> tracked_;
  std::vector<std::vector<Eigen::Vector3d>> tracks_;  // of each track, its point at every recorded state
  std::vector<Tie> ties_;
  Picture picture_;
};

/// Draws frame_000000.png for each of the frames, which are taken at number / frame_rate seconds, into an
/// existing folder; size: the scene's. Throws as Film, Renderer and write_png do.
void render_frames(const std::filesystem::path& folder, const Scene& scene, const Model& model,
                   const Recording& recording, double frame_rate, const std::vector<std::int64_t>& frames,
                   Progress& progress, GlBackend backend = GlBackend::automatic);

}  // namespace pliant
