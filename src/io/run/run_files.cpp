#include <pliant/io/run/run_files.h>

#include <algorithm>
#include <array>
#include <cctype>

#include <pliant/scene/mesh_file.h>

namespace pliant {
namespace {

constexpr const char* kPart = ".part-";

bool all_digits(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool is_frame(const std::string& name, const std::string& ending) {
  const std::string head = "frame_", tail = "." + ending;
  return name.size() >= head.size() + 6 + tail.size() && name.compare(0, head.size(), head) == 0 &&
         name.compare(name.size() - tail.size(), tail.size(), tail) == 0 &&
         all_digits(name.substr(head.size(), name.size() - head.size() - tail.size()));
}

}  // namespace

std::string finished_name(const std::string& name) {
  return writing_process(name) < 0 ? name : name.substr(0, name.rfind(kPart));
}

int writing_process(const std::string& name) {
  const std::size_t mark = name.rfind(kPart);
  if (mark == std::string::npos) return -1;
  const std::string tail = name.substr(mark + std::string(kPart).size());
  const std::size_t dash = tail.find('-');
  constexpr std::size_t max_digits = 9;  // every number with nine digits is an int
  if (dash == std::string::npos || dash > max_digits || !all_digits(tail.substr(0, dash)) ||
      !all_digits(tail.substr(dash + 1)))
    return -1;
  return std::stoi(tail.substr(0, dash));
}

std::string frame_name(const std::string& stem, std::int64_t number, const std::string& ending) {
  std::string digits = std::to_string(number);
  if (digits.size() < 6) digits.insert(0, 6 - digits.size(), '0');
  return stem + "_" + digits + "." + ending;
}

bool is_run_file(const std::filesystem::path& relative) {
  static constexpr std::array<const char*, 20> top{
      kNewRunFile,           kRunFile,           kSceneFile,
      kLayoutFile,           kTimesFile,         kCoordinatesFile,
      kVelocitiesFile,       kModesFile,         kWorkFile,
      kChecksumsFile,        kContactCacheFile,  kCheckpointFiles[0],
      kCheckpointFiles[1],   kTrajectoryFile,    kContactsFile,
      kContactsTable,        kJointImpulsesFile, kJointImpulsesTable,
      kContactChecksumsFile, kLockFile};
  const std::string folder = relative.parent_path().string(),
                    name = finished_name(relative.filename().string());
  if (folder.empty()) return std::find(top.begin(), top.end(), name) != top.end() || is_recorded_mesh(name);
  if (folder == kMeshFolder) return name == kMaterialFile || is_frame(name, "obj") || is_frame(name, "ply");
  return folder == kFrameFolder && is_frame(name, "png");
}

}  // namespace pliant
