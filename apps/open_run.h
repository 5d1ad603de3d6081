// A finished or unfinished run, opened for reading. The scene is built from the copy in the folder of the
// run.
#pragma once

#include <filesystem>
#include <memory>

#include <pliant/io/recording.h>
#include <pliant/io/run/run_record.h>
#include <pliant/scene/scene.h>

namespace pliant_cli {

struct OpenRun {
  pliant::RunRecord record;
  std::unique_ptr<pliant::Scene> scene;
  std::unique_ptr<pliant::Model> model;
  std::unique_ptr<pliant::Recording> recording;

  /// Returns the number of frames from time 0 to the last recorded time.
  std::int64_t frames() const;
};

/// Opens the run in a folder. Throws pliant::RecordingMismatch if the scene is missing or was changed. Also
/// throws this exception if run.json or the recording is damaged, or if the recording has no state or an
/// unknown version. Throws pliant::FileError, pliant::SceneError or std::system_error if the folder has no
/// run or a file of the run cannot be read.
OpenRun open_run(const std::filesystem::path& folder);

/// Creates a folder for frames, and its parent folders, if they do not exist. frames: numbers of the frames.
/// ending: extension of the file names. Throws pliant::OutputRefused if a file or a symbolic link has the
/// name of the folder, or if a file of one of the frames exists and `force` is false.
void prepare_frame_folder(const std::filesystem::path& folder, const std::vector<std::int64_t>& frames,
                          const std::string& ending, bool force);

}  // namespace pliant_cli
