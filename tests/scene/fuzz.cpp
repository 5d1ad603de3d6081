// Any file content gives a scene that can run, a SceneError, or an UnsatisfiableModel for joints that cannot
// close. There is no other exception, and no crash. The test mutates the bytes and values of the scenes in
// scenes/ and bad/ in thousands of ways, which are the same in each run of the test.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/io/frame_schedule.h>
#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"

namespace fuzz_test {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

// With sanitizers a case takes thirty times as long. Builds with sanitizers run one in kEach cases.
#ifdef PLIANT_SANITIZED
constexpr int kEach = 16;
#else
constexpr int kEach = 1;
#endif

struct Sample {
  std::string name, text;
};

std::vector<Sample> samples(const fs::path& folder) {
  std::vector<Sample> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".json" || name == "pliant-scene.schema.json") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    all.push_back({name, {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}});
  }
  std::sort(all.begin(), all.end(), [](const Sample& a, const Sample& b) { return a.name < b.name; });
  return all;
}

class Mutator {
 public:
  /// The random mutations of a scene depend only on its name, and not on other scenes.
  explicit Mutator(const std::string& name) {
    std::seed_seq seed(name.begin(), name.end());
    random_.seed(seed);
  }

  /// Returns a text with one to four random changes of its bytes.
  std::string mutate_bytes(std::string text) {
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      const std::size_t at = below(text.size() + 1), length = std::min(below(20), text.size() - at);
      switch (below(5)) {
        case 0:
          if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
          break;
        case 1:
          text.insert(at, 1, kBytes[below(kBytes.size())]);
          break;
        case 2:
          text.erase(at, length);
          break;
        case 3:
          text.insert(at, text.substr(below(text.size() + 1), below(20)));
          break;
        default:
          text.resize(below(2) == 0 ? at : text.size());
      }
    }
    return text;
  }

  /// Returns a document with one to three random changes: a value is replaced, or a key is removed or copied
  /// to a misspelt key.
  std::string mutate_values(Json document) {
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
      std::vector<std::string> places;
      const Json flat = document.flatten();
      for (const auto& [pointer, value] : flat.items()) {
        for (std::size_t end = pointer.size(); end != std::string::npos && end > 0;
             end = pointer.rfind('/', end - 1))
          places.push_back(pointer.substr(0, end));
      }
      if (places.empty()) break;
      const Json::json_pointer place(places[below(places.size())]);
      if (!document.contains(place)) continue;
      Json& parent = document[place.parent_pointer()];
      switch (below(8)) {
        case 0:
          if (parent.is_object()) parent.erase(place.back());
          break;
        case 1:
          if (parent.is_object()) parent[place.back() + "x"] = parent[place.back()];
          break;
        case 2:
          document[place] = Json(document[Json::json_pointer(places[below(places.size())])]);
          break;
        case 3:
        case 4:
          if (document[place].is_number())
            document[place] =
                document[place].get<double>() * std::pow(10.0, static_cast<int>(below(25)) - 12);
          break;
        default:
          document[place] = Json::parse(odd_values()[below(odd_values().size())]);
      }
    }
    return document.dump(1, ' ', false, Json::error_handler_t::replace);
  }

 private:
  static const std::vector<std::string>& odd_values() {
    static const std::vector<std::string> all = {"null",
                                                 "true",
                                                 "\"\"",
                                                 "\"x\"",
                                                 "\"ball\"",
                                                 "\"t\"",
                                                 "\"sqrt(-t)\"",
                                                 "\"1/t\"",
                                                 "\"1e300*exp(99*t)\"",
                                                 "0",
                                                 "-0.0",
                                                 "-1",
                                                 "1",
                                                 "0.5",
                                                 "2",
                                                 "3.7",
                                                 "100",
                                                 "1e-12",
                                                 "1e12",
                                                 "1e-300",
                                                 "5e-324",
                                                 "1e100",
                                                 "1e300",
                                                 "1.7e308",
                                                 "-1e308",
                                                 "2147483648",
                                                 "9007199254740993",
                                                 "[]",
                                                 "{}",
                                                 "[0, 0, 0]",
                                                 "[1, 2, 3]",
                                                 "[1e300, -1e300, 1e300]",
                                                 "[1e-200, 0, 0]",
                                                 "[0, 0, 0, 1e200]",
                                                 "[\"t\", 0, \"-t\"]",
                                                 "{\"rest\": 1, \"stiffness\": 1e300}",
                                                 "{\"dynamic\": true}",
                                                 "{\"t\": [0, 1], \"y\": [1, 2]}",
                                                 "[\"bend\", \"taper\", \"bend\"]",
                                                 "\"superellipsoid\"",
                                                 "\"supertoroid\"",
                                                 "\"cone\""};
    return all;
  }
  static constexpr std::string_view kBytes = "{}[]\",:0123456789.eE+-\\/ \n\t\x01\x7f\xc3\xff";
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  std::mt19937 random_;
};

enum class Outcome { refused, ready };

/// Loads a scene as `pliant check` does before its trial steps. Returns `refused` for a SceneError or an
/// UnsatisfiableModel. Throws all other exceptions.
Outcome load(const std::string& name, const std::string& text) {
  pliant::Diagnostics diagnostics;
  try {
    const auto scene = pliant::parse_scene(name, text, {}, diagnostics);
    const pliant::FrameSchedule schedule(scene->end, scene->step, scene->frame_rate);
    const pliant::Simulation simulation(scene->body, scene->integrator);
    return Outcome::ready;
  } catch (const pliant::SceneError& error) {
    CHECK(error.diagnostics().errors() > 0);
    CHECK(std::string(error.what()).find(name + ":") == 0);
    return Outcome::refused;
  } catch (const pliant::UnsatisfiableModel& failure) {  // a valid scene whose joints cannot close
    const std::string what = failure.what();
    INFO(what);
    const bool names_the_cause = what.find("cannot close") != std::string::npos ||
                                 what.find("joints contradict each other") != std::string::npos;
    CHECK(names_the_cause);
    return Outcome::refused;
  }
}

/// Loads a mutated scene and adds 1 to `ready` if the scene can run. The test fails, and prints the scene, if
/// load() throws.
void load_mutated(const Sample& sample, const std::string& text, int* ready) {
  try {
    *ready += load(sample.name, text) == Outcome::ready ? 1 : 0;
  } catch (const std::exception& error) {
    FAIL_CHECK(sample.name << ": " << error.what() << "\n" << text);
  }
}

}  // namespace

TEST_CASE("mutated scenes are refused with a message or can run") {
  struct CaseCounts {
    const char* folder;
    int by_bytes, by_values;
  };
  int cases = 0, ready = 0;
  for (const CaseCounts& counts : {CaseCounts{PLIANT_SCENES, 20, 40}, CaseCounts{PLIANT_BAD_SCENES, 8, 8}}) {
    for (const Sample& sample : samples(counts.folder)) {
      // These scenes take a second to load: they have dynamic exponents, almost a hundred parts, or
      // elasticity.
      if (sample.name == "gallery.json" || sample.name == "net.json" || sample.name == "rubber_bars.json")
        continue;
      Mutator mutator(sample.name);
      for (int i = 0; i < std::max(1, counts.by_bytes / kEach); ++i, ++cases)
        load_mutated(sample, mutator.mutate_bytes(sample.text), &ready);
      const Json document = Json::parse(sample.text, nullptr, false);
      if (document.is_discarded()) continue;
      for (int i = 0; i < std::max(1, counts.by_values / kEach); ++i, ++cases)
        load_mutated(sample, mutator.mutate_values(document), &ready);
    }
  }
  CHECK(cases > 3000 / kEach);
  CHECK(ready > 300 / kEach);
}

}  // namespace fuzz_test
