// Verification of the folder of a run: whether a file is missing or damaged.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/io/run/run_record.h>
#include <pliant/scene/scene.h>

namespace pliant {

struct Verification {
  std::vector<std::string> checked;  ///< one text for each kind of file that was checked
  std::vector<std::string> faults;   ///< texts about files and states that are damaged or missing
};

/// A run whose files are verified.
struct VerifiedRun {
  std::filesystem::path folder;
  const RunRecord& record;
  const Scene& scene;
  const Model& model;
  const Recording& recording;
  std::int64_t frames;  ///< number of frames of the run
};

/// Compares the files of a run that have a checksum in run.json, except the tables, with this checksum.
void verify_whole_files(const std::filesystem::path& folder, const RunRecord& record, Verification& result);

/// Compares all numbers of the tables with their checksums, these checksums with the checksums in run.json,
/// and each state with its check number.
void verify_tables(const VerifiedRun& run, Verification& result);

/// If run.json lists OBJ files or pictures, checks that the file of each frame exists. An OBJ file must have
/// the bytes that the recording gives, and a picture must be undamaged (check_png()). Throws Interrupted.
void verify_frames(const VerifiedRun& run, Progress& progress, Verification& result);

}  // namespace pliant
