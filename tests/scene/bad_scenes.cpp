// Each scene bad/NAME.json must be refused. The text of the exception must equal the file bad/NAME.txt. After
// an intended change of a message, run this test with PLIANT_REWRITE_GOLDENS=1 in the environment. The test
// then writes all files bad/NAME.txt again. Review the changes with git diff.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <pliant/scene/read_scene.h>

#include "catch.h"

namespace bad_scenes_test {

namespace fs = std::filesystem;

namespace {

/// Returns the sorted names of the files with this ending in the folder bad, without the ending.
std::vector<std::string> bad_scenes(const std::string& ending) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(PLIANT_BAD_SCENES))
    if (entry.path().extension() == ending) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Returns the text of the SceneError for a file; "accepted" and the warnings if the scene is read.
std::string refusal(const std::string& file) {
  pliant::Diagnostics diagnostics;
  try {
    pliant::read_scene(file, {}, diagnostics);
  } catch (const pliant::SceneError& error) {
    return error.what();
  }
  return "accepted\n" + diagnostics.text();
}

}  // namespace

TEST_CASE("every bad scene is refused with its expected message") {
  const std::vector<std::string> names = bad_scenes(".json");
  CHECK(names.size() >= 60);
  CHECK(bad_scenes(".txt") == names);
  const bool rewrite = std::getenv("PLIANT_REWRITE_GOLDENS") != nullptr;
  const fs::path before = fs::current_path();
  fs::current_path(PLIANT_BAD_SCENES);  // messages then contain the name of the file without folders
  for (const std::string& name : names) {
    INFO(name);
    const std::string message = refusal(name + ".json");
    if (rewrite) std::ofstream(name + ".txt", std::ios::binary) << message;
    CHECK(message == bytes_of(name + ".txt"));
    CHECK(message.find("accepted") != 0);
  }
  fs::current_path(before);
}

}  // namespace bad_scenes_test
