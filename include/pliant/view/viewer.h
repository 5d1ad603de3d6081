// The window that shows a running scene or a recording. It needs GLFW and Dear ImGui when pliant is built.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <stdexcept>
#include <string>

#include <pliant/io/recording.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// Thrown if no window opens: this build has none, or there is no display. The message has the reason.
class NoWindow : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ViewOptions {
  int width = 960, height = 540;  ///< of the window, pixels
  int threads = 0;     ///< of the simulation; 0: by the cost of the scene, at most the processors minus one
  bool plays = false;  ///< whether the motion starts at once
  std::filesystem::path scene_folder = ".";  ///< folder of the scene, to which its mesh files are relative
  std::filesystem::path saved;               ///< the file that the button "save" writes
  /// File of synthetic input (README.md of this folder), which drives the window in place of a user. Empty:
  /// no such file.
  std::filesystem::path script;
  double bench =
      0;  ///< above 0: plays for this wall time (s), prints frames per second and speed, and closes
};

/// Returns the Debian packages that this build lacks for a window, separated by " and "; empty if the build
/// has a window.
std::string missing_window_packages();

/// Simulates a scene in a window until the user closes it. out: for the results of scripts and benches.
/// Throws NoWindow, std::invalid_argument for a script that cannot be read or has a faulty line, and what
/// LiveSimulation, StatePicture and WindowRenderer throw.
void view_scene(Scene& scene, const ViewOptions& options, std::ostream& out);

/// Shows a recording in a window until the user closes it. Throws as view_scene() does.
void view_recording(Scene& scene, const Model& model, const Recording& recording, const ViewOptions& options,
                    std::ostream& out);

}  // namespace pliant
