// A finished (or unfinished) run opened for reading: its scene is built again from the copy beside the
// recording.
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

  /// Frames that the recording reaches.
  std::int64_t frames() const;
};

/// Throws pliant::FileError when the folder holds no run, pliant::RecordingMismatch when this program cannot
/// read it.
OpenRun open_run(const std::filesystem::path& folder);

/// Makes a folder for frames where there is none. Throws pliant::OutputRefused when a file of one of these
/// frames exists and `force` is not given.
void prepare_frame_folder(const std::filesystem::path& folder, const std::vector<std::int64_t>& frames,
                          const std::string& ending, bool force);

}  // namespace pliant_cli
