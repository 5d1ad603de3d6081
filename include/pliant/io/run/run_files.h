// The names of the files in the folder of a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace pliant {

inline constexpr const char* kRunFile = "run.json";        ///< the run record: options, progress, cost, notes
inline constexpr const char* kSceneFile = "scene.json";    ///< the text of the scene file
inline constexpr const char* kLayoutFile = "layout.json";  ///< the columns of the tables
inline constexpr int kRecordingVersion = 5;                ///< version of layout.json and the tables
inline constexpr const char* kTimesFile = "t.npy";
inline constexpr const char* kCoordinatesFile = "q.npy";
inline constexpr const char* kVelocitiesFile = "v.npy";
inline constexpr const char* kModesFile = "modes.npy";  ///< entries of a state besides t, q and v
inline constexpr const char* kWorkFile = "work.npy";    ///< the counters of the run up to each state
inline constexpr const char* kContactCacheFile =
    "supports.npy";  ///< the contact cache of a state: contacts for the warm start of the next step
inline constexpr const char* kChecksumsFile = "checksums.npy";  ///< checksums of the tables of states
/// Two checkpoint files, each with one state between two recorded states. A new checkpoint replaces the older
/// checkpoint.
inline constexpr const char* kCheckpointFiles[] = {"checkpoint_1.npy", "checkpoint_2.npy"};
inline constexpr const char* kTrajectoryFile = "trajectory.csv";
// Files of a run that records contacts: tables written during the run, and CSV files written at its end.
inline constexpr const char* kContactsFile = "contacts.npy";
inline constexpr const char* kContactsTable = "contacts.csv";
inline constexpr const char* kJointImpulsesFile = "joint_impulses.npy";
inline constexpr const char* kJointImpulsesTable = "joint_impulses.csv";
/// Checksums of contacts.npy and joint_impulses.npy.
inline constexpr const char* kContactChecksumsFile = "contact_checksums.npy";
inline constexpr const char* kLockFile = "pliant.lock";  ///< exists while a run uses the folder
inline constexpr const char* kMeshFolder = "meshes";
inline constexpr const char* kFrameFolder = "frames";
inline constexpr const char* kMaterialFile = "parts.mtl";  ///< colours of meshes; in kMeshFolder

// The beginning of a new run, see run_folder.h. The files of the new run are first in a folder inside the
// folder of the run. The name of this inner folder is kNewRun with the ending ".part-PID-N" while the files
// are written, kWholeNewRun when all files are whole, and kMovingNewRun while the files are moved to the
// folder of the run. kNewRunFile is a file in the folder of the run.
inline constexpr const char* kNewRun = "new_run";
inline constexpr const char* kNewRunFile = "new_run.json";  ///< options of a run that has not begun
inline constexpr const char* kWholeNewRun = "new_run.whole";
inline constexpr const char* kMovingNewRun = "new_run.moving";

/// Returns the file name of a frame, "frame_000012.png": stem, number with at least six digits, extension.
std::string frame_name(const std::string& stem, std::int64_t number, const std::string& ending);

/// Returns the final name of a file or folder: NAME for the temporary name "NAME.part-PID-N", else the name
/// itself.
std::string finished_name(const std::string& name);
/// Returns the number of the process that writes the file with a temporary name; -1 for another name.
int writing_process(const std::string& name);

/// Returns whether `pliant run`, `render` or `export` writes a file, finished or not, with this path relative
/// to the folder of a run.
bool is_run_file(const std::filesystem::path& relative);

}  // namespace pliant
