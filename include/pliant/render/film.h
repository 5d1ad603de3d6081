// The pictures of the frames of a run, drawn from its recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/render/picture.h>
#include <pliant/render/renderer.h>
#include <pliant/render/state_picture.h>
#include <pliant/render/track_lines.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// Makes the picture at any time of a recording: the picture of the state at this time (StatePicture), with
/// the tracks up to this time. All frames of a run have the same camera, ground and scale of values. If the
/// scene does not set these, they are computed from the whole recorded motion.
class Film {
 public:
  /// scene, model, recording: must outlive the film. Throws RecordingMismatch, and std::out_of_range if the
  /// recording has no state.
  Film(const Scene& scene, const Model& model, const Recording& recording);

  /// Returns the picture at a time (s). The reference is valid until the next call.
  const Picture& at(double time);
  const Camera& camera() const { return shown_.picture().camera; }
  /// The last picture with its meshes. The caller may change the camera of all later pictures.
  StatePicture& shown() { return shown_; }

 private:
  void choose_view();
  void choose_scale();

  const Scene* scene_;
  const Recording* recording_;
  StatePicture shown_;
  std::vector<TrackLine> tracks_;
};

/// A recorded motion with the scene and the model that it belongs to.
struct FilmSource {
  const Scene& scene;
  const Model& model;
  const Recording& recording;
};

/// Draws the given frames into an existing folder, as frame_000000.png and so on; frame i is at the time
/// i / frame_rate (s). The scene gives the size of the pictures. Throws what Film, Renderer and write_png
/// throw.
void render_frames(const std::filesystem::path& folder, const FilmSource& source, double frame_rate,
                   const std::vector<std::int64_t>& frames, Progress& progress,
                   GlBackend backend = GlBackend::automatic);

}  // namespace pliant
