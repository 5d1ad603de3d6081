// The names of the files of a run's folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace pliant {

inline constexpr const char* kRunFile = "run.json";        ///< how far the run came, and how
inline constexpr const char* kSceneFile = "scene.json";    ///< the scene as it was read
inline constexpr const char* kLayoutFile = "layout.json";  ///< the columns of the tables
inline constexpr int kRecordingVersion = 3;                ///< of it and the tables
inline constexpr const char* kTimesFile = "t.npy";
inline constexpr const char* kCoordinatesFile = "q.npy";
inline constexpr const char* kVelocitiesFile = "v.npy";
inline constexpr const char* kModesFile = "modes.npy";  ///< what else a state holds
inline constexpr const char* kContactCacheFile =
    "supports.npy";  ///< and what contacts begin the next step with
inline constexpr const char* kTrajectoryFile = "trajectory.csv";
// Of a run that tells what touches, recorded and for people:
inline constexpr const char* kContactsFile = "contacts.npy";
inline constexpr const char* kContactsTable = "contacts.csv";
inline constexpr const char* kJointImpulsesFile = "joint_impulses.npy";
inline constexpr const char* kJointImpulsesTable = "joint_impulses.csv";
inline constexpr const char* kLockFile = "pliant.lock";  ///< there while a run uses the folder
inline constexpr const char* kMeshFolder = "meshes";
inline constexpr const char* kFrameFolder = "frames";
inline constexpr const char* kMaterialFile = "parts.mtl";  ///< in kMeshFolder: colours

/// "frame_000012.png": stem, number with at least six digits, ending.
std::string frame_name(const std::string& stem, std::int64_t number, const std::string& ending);

/// Whether a path relative to a run's folder is of a file that a run, render or export writes there, finished
/// or not.
bool is_run_file(const std::filesystem::path& relative);

}  // namespace pliant
