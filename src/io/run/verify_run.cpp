#include <pliant/io/run/verify_run.h>

#include <algorithm>
#include <functional>
#include <system_error>
#include <utility>

#include <pliant/io/contact_recording.h>
#include <pliant/io/format/number_text.h>
#include <pliant/io/format/obj.h>
#include <pliant/io/format/png.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/io/run/run_files.h>

namespace fs = std::filesystem;

namespace pliant {
namespace {

bool is_table(const std::string& file) {
  return fs::path(file).extension() == ".npy";
}

bool lists(const RunRecord& record, const std::string& file) {
  return std::find(record.files.begin(), record.files.end(), file) != record.files.end();
}

/// Performs a check. If the check throws, adds the message of the exception to the faults of a verification.
void attempt(Verification& result, const std::function<void()>& check) {
  try {
    check();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& fault) {
    result.faults.emplace_back(fault.what());
  }
}

/// Adds a fault for each table whose checksum differs from the checksum in run.json. now: the checksums of
/// the tables after the number of states that run.json gives.
void compare_checksums(const fs::path& folder, const RunRecord& record, const Checksums& now,
                       Verification& result) {
  for (const auto& [table, checksum] : now)
    for (const auto& [file, recorded] : record.checksums)
      if (file == table && recorded != checksum)
        result.faults.push_back((folder / table).string() + ": the numbers of its first " +
                                count_text(record.states, "state") + " have the checksum " +
                                crc32_text(checksum) + ", and run.json gives " + crc32_text(recorded));
}

/// The files of all frames in a folder.
struct Series {
  fs::path folder;
  const char* stage;
  const char* ending;
  std::function<void(const fs::path&, std::int64_t)> check;  ///< throws if the file of a frame is damaged
};

void verify_series(const Series& series, std::int64_t frames, Progress& progress, Verification& result) {
  progress.begin(std::string("verify ") + series.stage, static_cast<double>(frames), "frames");
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    const fs::path file = series.folder / frame_name("frame", frame, series.ending);
    if (fs::exists(file))
      attempt(result, [&] { series.check(file, frame); });
    else
      result.faults.push_back(file.string() + " is missing");
    progress.advance(static_cast<double>(frame + 1));
  }
  progress.end();
  result.checked.push_back(count_text(frames, "frame") + " in " + series.folder.string());
}

}  // namespace

void verify_whole_files(const fs::path& folder, const RunRecord& record, Verification& result) {
  std::string names = kRunFile;
  for (const auto& [file, recorded] : record.checksums) {
    if (is_table(file)) continue;
    names += ", " + file;
    attempt(result, [&folder, &result, &name = file, expected = recorded] {
      const std::uint32_t now = crc32_of_file(folder / name);
      if (now != expected)
        result.faults.push_back((folder / name).string() + " is damaged or was changed: its checksum is " +
                                crc32_text(now) + ", and run.json gives " + crc32_text(expected));
    });
  }
  result.checked.push_back(names);
}

void verify_tables(const VerifiedRun& run, Verification& result) {
  const fs::path& folder = run.folder;
  const RunRecord& record = run.record;
  const Recording& recording = run.recording;
  std::string names;
  for (const auto& entry : record.checksums)
    if (is_table(entry.first)) names += (names.empty() ? "" : ", ") + entry.first;
  for (std::string& text : recording.inspect().damage) result.faults.push_back(std::move(text));
  const bool all_there = recording.rows() >= record.states;
  auto compare = [&](const Checksums& now) { compare_checksums(folder, record, now, result); };
  if (all_there) attempt(result, [&] { compare(recording.checksums(record.states)); });
  auto check_contacts = [&] {
    const ChecksumReader contacts = contact_checksums(folder);
    const std::int64_t states = contacts.whole_states();
    for (std::string& text : contacts.inspect().damage) result.faults.push_back(std::move(text));
    if (states < std::min(record.states, recording.rows()))
      result.faults.push_back((folder / kContactsFile).string() + " or " +
                              (folder / kJointImpulsesFile).string() + " has the rows of only " +
                              count_text(states, "state"));
    else if (all_there)
      compare(contacts.checksums(record.states));
  };
  if (lists(record, kContactsFile)) attempt(result, check_contacts);
  for (std::int64_t row = 0; result.faults.empty() && row < recording.rows(); ++row)
    attempt(result, [&] { recording.state(row); });
  result.checked.push_back(count_text(recording.rows(), "state") + " in " + names);
}

void verify_frames(const VerifiedRun& run, Progress& progress, Verification& result) {
  if (lists(run.record, std::string(kMeshFolder) + "/frame_*.obj")) {
    FrameMeshes meshes(run.scene, run.model, FrameMeshes::Values::omitted);
    auto check_mesh = [&](const fs::path& file, std::int64_t frame) {
      const State state = run.recording.at(static_cast<double>(frame) / run.record.frame_rate);
      if (read_whole_file(file) != obj_text(meshes.at(state), kMaterialFile))
        result.faults.push_back(file.string() + " differs from the surfaces that the recording gives");
    };
    verify_series({run.folder / kMeshFolder, "meshes", "obj", check_mesh}, run.frames, progress, result);
  }
  if (lists(run.record, std::string(kFrameFolder) + "/frame_*.png"))
    verify_series({run.folder / kFrameFolder, "pictures", "png",
                   [](const fs::path& file, std::int64_t) { check_png(file); }},
                  run.frames, progress, result);
}

}  // namespace pliant
