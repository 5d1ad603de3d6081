// Scenes that must be refused, each beside the text that says why: bad/NAME.json and bad/NAME.txt, which is
// all that the exception says. When a wording is changed on purpose, PLIANT_REWRITE_GOLDENS=1 in the
// environment of this test writes the texts anew; read what git diff then shows as a user would.
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

/// The names of the scenes, without their endings.
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

TEST_CASE("every bad scene is refused in the words of its golden text") {
  const std::vector<std::string> names = bad_scenes(".json");
  CHECK(names.size() >= 60);
  CHECK(bad_scenes(".txt") == names);
  const bool rewrite = std::getenv("PLIANT_REWRITE_GOLDENS") != nullptr;
  const fs::path before = fs::current_path();
  fs::current_path(PLIANT_BAD_SCENES);  // messages name the file as it was given
  for (const std::string& name : names) {
    INFO(name);
    const std::string said = refusal(name + ".json");
    if (rewrite) std::ofstream(name + ".txt", std::ios::binary) << said;
    CHECK(said == bytes_of(name + ".txt"));
    CHECK(said.find("accepted") != 0);
  }
  fs::current_path(before);
}

}  // namespace bad_scenes_test
