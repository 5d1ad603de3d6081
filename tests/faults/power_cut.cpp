// After a power cut, the last rows of tables may be missing or zero, because they were not yet on the disk.
// The run is resumed from a state that is whole in all tables, and gives the files of an unbroken run.
// I53 and I55 in names of tests are rows of the table in tests/README.md.
#include <csignal>

#include <sys/syscall.h>

#include "catch.h"
#include "faulty_run.h"

namespace power_cut_test {

using namespace faults;

namespace {

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// Kills the run "killed" when it has written all states, and run.json does not say yet that they are on the
/// disk. Returns whether the run was killed there.
bool kill_before_end(const FaultyRun& place) {
  bool written = false;
  const Ended ended = place.traced(
      "killed", "",
      [&](const Call& call) {
        const bool in_place = !has(call.path, "new_run");
        if (call.what == SYS_fsync && in_place && has(call.path, "q.npy")) written = true;
        return Action{written && call.what == SYS_openat && has(call.path, "run.json.part"), 0};
      },
      true);
  return ended.code == 128 + SIGKILL;
}

/// Replaces the second half of the rows of a table by zeros, or removes these rows.
void lose_tail(const fs::path& table, bool zeros) {
  constexpr std::size_t kHeader = 128;
  std::string bytes = bytes_of(table);
  const std::size_t size = bytes.size(), middle = kHeader + (size - kHeader) / 2 + 3;
  bytes.resize(middle);
  if (zeros) bytes.resize(size, '\0');
  set_bytes(table, bytes);
}

}  // namespace

TEST_CASE("I53: a run whose tables have lost their tails in a power cut is resumed to the same files") {
  if (!tracing_works()) return;
  const FaultyRun place("--end 0.3");
  REQUIRE(place.run("unbroken") == 0);
  const auto unbroken = place.files("unbroken");
  REQUIRE(kill_before_end(place));
  std::vector<std::string> tables;
  for (const fs::directory_entry& entry : fs::directory_iterator(place / "killed"))
    if (entry.path().extension() == ".npy") tables.push_back(entry.path().filename().string());
  REQUIRE(tables.size() == 10);
  for (const std::string& table : tables)
    for (const bool zeros : {false, true}) {
      INFO(table << (zeros ? ", zeros" : ", cut"));
      place.copy("killed", "broken");
      lose_tail(place / ("broken/" + table), zeros);
      if (zeros) {
        CHECK(place.verify("broken") == 10);
        CHECK(has(place.output(), "broken/" + table + " is damaged"));
      }
      CHECK(place.wrong_after_resume("broken", unbroken) == "");
      const std::string record = bytes_of(place / "broken/run.json");
      CHECK(has(record, "were not yet on the disk when the run was interrupted") == zeros);
    }
  place.copy("killed", "broken");
  for (std::size_t i = 0; i < tables.size(); ++i) lose_tail(place / ("broken/" + tables[i]), i % 2 == 0);
  CHECK(place.wrong_after_resume("broken", unbroken) == "");
}

TEST_CASE("I55: damage in states that were on the disk is refused, also after a kill") {
  if (!tracing_works()) return;
  const FaultyRun place("--end 0.3");
  REQUIRE(kill_before_end(place));
  std::string bytes = bytes_of(place / "killed/q.npy");
  bytes[128 + 3] = static_cast<char>(bytes[128 + 3] ^ 1);  // in the first state
  set_bytes(place / "killed/q.npy", bytes);
  CHECK(place.resume("killed") == 10);
  CHECK(has(place.output(), "q.npy is damaged at row 0"));
  CHECK(has(place.output(), "Restore the damaged file, or simulate again with --force"));
}

}  // namespace power_cut_test
