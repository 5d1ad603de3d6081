// A finished or unfinished run, opened for reading. Its scene is built again from the copy in its folder.
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

  /// Returns the number of frames up to the last recorded time.
  std::int64_t frames() const;
};

/// Opens the run in a folder. Throws pliant::FileError if the folder has no run. Throws
/// pliant::RecordingMismatch if the scene is missing or was changed, if the recording is damaged or has no
/// state, or if this program cannot read a file.
OpenRun open_run(const std::filesystem::path& folder);

/// Makes a folder for frames, and its parent folders, if they do not exist. frames: numbers of the frames.
/// ending: extension of the file names. Throws pliant::OutputRefused if a file of one of the frames exists
/// and `force` is false.
void prepare_frame_folder(const std::filesystem::path& folder, const std::vector<std::int64_t>& frames,
                          const std::string& ending, bool force);

}  // namespace pliant_cli
