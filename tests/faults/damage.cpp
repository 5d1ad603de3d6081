// One bit is flipped in a file of a run. `pliant verify` names the damaged file. `pliant run --resume`
// refuses the run and names the file, or gives the files of an uninterrupted run.
// I55 in the name of a test is a row of the table in tests/README.md.
#include <algorithm>

#include "catch.h"
#include "faulty_run.h"

namespace damage_test {

using namespace faults;

namespace {

constexpr std::size_t kNpyHeader = 128;

void flip_bit(const fs::path& file, std::size_t byte, int bit) {
  std::string bytes = bytes_of(file);
  bytes.at(byte) = static_cast<char>(bytes.at(byte) ^ (1 << bit));
  set_bytes(file, bytes);
}

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("I55: verify finds one flipped bit in any file of a run, and resume refuses or repairs the run",
          "[long]") {
  const FaultyRun place("--end 0.1", "--obj --quiet");
  REQUIRE(place.run("whole") == 0);
  const auto whole = place.files("whole");
  REQUIRE(place.verify("whole") == 0);
  CHECK(has(place.output(),
            "checked: 11 states in t.npy, q.npy, v.npy, modes.npy, work.npy, supports.npy, contacts.npy"));
  CHECK(has(place.output(), "checked: 11 frames in whole/meshes"));
  CHECK(has(place.output(), "no fault found"));
  for (const auto& entry : whole) {
    const std::string& name = entry.first;
    if (fs::is_directory(place / ("whole/" + name)) || name == "meshes/parts.mtl") continue;
    const bool table = fs::path(name).extension() == ".npy";
    const std::size_t size = fs::file_size(place / ("whole/" + name)), first = table ? kNpyHeader : 0;
    if (fs::path(name).extension() == ".obj" && name != "meshes/frame_000007.obj") continue;
    for (const std::size_t byte : {first, first + (size - first) / 3, size - 1}) {
      place.copy("whole", "damaged");
      flip_bit(place / ("damaged/" + name), byte, static_cast<int>(byte % 8));
      INFO(name << ", byte " << byte << " of " << size);
      CHECK(place.verify("damaged") == 10);
      CHECK(has(place.output(), "damaged/" + name));
      const int code = place.resume("damaged");
      INFO(place.output());
      if (table || name == "run.json") {
        CHECK(code == 10);
        CHECK(has(place.output(), "damaged/" + name));
        if (table) CHECK(has(place.output(), " at row "));
      } else {
        CHECK(code == 0);
        CHECK(difference(place.files("damaged"), whole) == "");
      }
    }
  }
}

TEST_CASE("I55: verify finds flipped bits in pictures") {
  const FaultyRun place("--end 0.01", "--png --quiet");
  REQUIRE(place.run("whole") == 0);
  REQUIRE(place.verify("whole") == 0);
  CHECK(has(place.output(), "checked: 2 frames in whole/frames"));
  const std::string picture = "damaged/frames/frame_000001.png";
  const std::size_t size = fs::file_size(place / "whole/frames/frame_000001.png");
  for (std::size_t byte = 0; byte < size; byte += size / 20) {
    place.copy("whole", "damaged");
    flip_bit(place / picture, byte, 5);
    INFO("byte " << byte << " of " << size);
    CHECK(place.verify("damaged") == 10);
    CHECK(has(place.output(), picture + " is damaged"));
  }
}

TEST_CASE("I55: verify reports frames and tables that are missing or cut") {
  const FaultyRun place("--end 0.1", "--obj --quiet");
  REQUIRE(place.run("whole") == 0);
  const auto whole = place.files("whole");
  for (const std::string name : {"contacts.npy", "supports.npy", "q.npy", "checksums.npy", "t.npy"}) {
    place.copy("whole", "damaged");
    INFO(name);
    fs::resize_file(place / ("damaged/" + name), fs::file_size(place / ("whole/" + name)) - 1);
    CHECK(place.verify("damaged") == 10);
    CHECK(place.resume("damaged") == 0);  // the lost states are simulated again
    CHECK(difference(place.files("damaged"), whole) == "");
    fs::remove(place / ("damaged/" + name));
    CHECK(place.verify("damaged") == 10);
    CHECK(has(place.output(), "damaged/" + name));
  }
  place.copy("whole", "damaged");
  fs::remove(place / "damaged/meshes/frame_000003.obj");
  CHECK(place.verify("damaged") == 10);
  CHECK(has(place.output(), "damaged/meshes/frame_000003.obj is missing"));
  CHECK(place.verify("nothing") == 3);
}

TEST_CASE("two runs have equal trajectory hashes in run.json if and only if their motion is the same") {
  const FaultyRun place("--end 0.1");
  REQUIRE(place.run("one") == 0);
  REQUIRE(place.run("other", "--threads 1") == 0);
  REQUIRE(place.run("heavy", "--set /parts/0/density=2000") == 0);
  auto hash = [&](const std::string& run) {
    const std::string record = bytes_of(place / (run + "/run.json")), key = "\"trajectory_hash\": \"";
    return record.substr(record.find(key) + key.size(), 16);
  };
  CHECK(hash("one").find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(hash("one") == hash("other"));
  CHECK(hash("one") != hash("heavy"));
}

TEST_CASE("a damaged checkpoint is reported, and the run continues from an earlier state to the same files") {
  const FaultyRun place("--set /output/frame_rate=4", "--checkpoint-every 0 --quiet");
  REQUIRE(place.run("whole") == 0);
  const auto whole = place.files("whole");
  if (!tracing_works()) return;
  for (const std::string damaged : {"", "1", "2", "12"}) {
    fs::remove_all(place / "r");
    // Between two frames, all states are in checkpoints only.
    long calls = place.traced("r", "", [](const Call&) { return Action{}; }).calls;
    fs::remove_all(place / "r");
    REQUIRE(place.traced("r", "",
                         [&](const Call& now) {
                           return Action{now.number == calls / 2, 0};
                         })
                .code == 128 + SIGKILL);
    for (const char which : damaged)
      flip_bit(place / (std::string("r/checkpoint_") + which + ".npy"), kNpyHeader + 40, 3);
    REQUIRE(place.resume("r") == 0);
    INFO("damaged: " << damaged << "\n" << place.output());
    CHECK(difference(place.files("r"), whole) == "");
    const std::string record = bytes_of(place / "r/run.json");
    for (const char which : damaged)
      CHECK(has(record, std::string("checkpoint_") + which + ".npy is damaged"));
  }
}

}  // namespace damage_test
