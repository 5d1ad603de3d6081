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

  /// Number of frames up to the last recorded time.
  std::int64_t frames() const;
};

/// Opens the run in a folder. Throws pliant::FileError if there is none, and pliant::RecordingMismatch if
/// this program cannot read it.
OpenRun open_run(const std::filesystem::path& folder);

/// Makes a folder for frames if there is none. ending: extension of the file names. Throws
/// pliant::OutputRefused if a file of one of the frames exists and `force` is false.
void prepare_frame_folder(const std::filesystem::path& folder, const std::vector<std::int64_t>& frames,
                          const std::string& ending, bool force);

}  // namespace pliant_cli
