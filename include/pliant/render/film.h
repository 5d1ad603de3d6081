// The pictures of the frames of a run, drawn from its recording.
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

/// Makes the picture at any time of a recording: the visible parts, obstacles and planes, the tracks up to
/// that time, and springs, rods and strings as thin lines. Each point of a spring or a joint that is attached
/// to the world is a dot. Scene::show_springs switches these lines and dots off. All frames of a run have the
/// same camera, ground and scale of values. If the scene does not set these, they are computed from the whole
/// recorded motion.
class Film {
 public:
  /// scene, model, recording: must outlive the film. Throws RecordingMismatch, and std::out_of_range if the
  /// recording has no state.
  Film(const Scene& scene, const Model& model, const Recording& recording);

  /// Returns the picture at a time (s). The reference is valid until the next call.
  const Picture& at(double time);
  const Camera& camera() const { return picture_.camera; }

 private:
  /// A spring or a joint as it is drawn.
  struct Connector {
    std::vector<PlacedPoint> ends;  ///< two points, or one for a joint without a second point
    bool line;                      ///< whether a line connects the ends
    const Joint* joint;             ///< nullptr for a spring
  };
  void build_tracks();
  void build_connectors();
  Eigen::AlignedBox3d anchors(const Eigen::AlignedBox3d& bodies) const;
  void draw_connectors(const State& state);
  void choose_view();
  void choose_scale();

  const Scene* scene_;
  const Model* model_;
  const Recording* recording_;
  FrameMeshes meshes_;
  std::vector<PlacedPoint> tracked_;
  std::vector<std::vector<Eigen::Vector3d>> tracks_;  // for each track, its point at every recorded state
  std::vector<Connector> connectors_;
  Picture picture_;
};

/// A recorded motion with the scene and the model that it belongs to.
struct FilmSource {
  const Scene& scene;
  const Model& model;
  const Recording& recording;
};

/// Draws the given frames into an existing folder, as frame_000000.png and so on; frame i is at the time
/// i / frame_rate (s). The size of the pictures is that of the scene. Throws what Film, Renderer and
/// write_png throw.
void render_frames(const std::filesystem::path& folder, const FilmSource& source, double frame_rate,
                   const std::vector<std::int64_t>& frames, Progress& progress,
                   GlBackend backend = GlBackend::automatic);

}  // namespace pliant
