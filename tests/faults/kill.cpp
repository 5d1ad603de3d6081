// A run is killed at one of its system calls. The resumed run gives the files of an uninterrupted run.
// I53 in the name of a test is a row of the table in tests/README.md.
#include <algorithm>

#include "catch.h"
#include "faulty_run.h"

namespace kill_test {

using namespace faults;

namespace {

/// Kills a run at a call and resumes the run. Returns a description of the first wrong result, or an empty
/// text.
std::string kill_and_resume(const FaultyRun& place, long call,
                            const std::map<std::string, std::string>& unbroken) {
  fs::remove_all(place / "broken");
  const Ended ended = place.traced("broken", "", [call](const Call& now) {
    return Action{now.number == call, 0};
  });
  if (ended.code != 128 + SIGKILL) return ended.code == 0 ? "" : "the run ended with an error";
  return place.wrong_after_resume("broken", unbroken);
}

/// Returns numbers of calls at which runs are killed: `early` numbers spread over the first 600 calls, and
/// `late` numbers spread over the later calls. all: number of calls of a run.
std::vector<long> calls_to_kill(long all, long early, long late) {
  std::vector<long> calls;
  const long first = std::min(600L, all);
  for (long i = 0; i < early; ++i) calls.push_back(1 + i * first / early);
  for (long i = 0; i < late; ++i) calls.push_back(first + i * (all - first) / late);
  return calls;
}

/// Kills runs at `early` and `late` calls (calls_to_kill()), resumes them, and compares their files with an
/// uninterrupted run.
void check_kills(const FaultyRun& place, long early, long late) {
  if (!tracing_works()) return;
  REQUIRE(place.run("unbroken") == 0);
  const auto unbroken = place.files("unbroken");
  const Ended whole = place.traced("broken", "", [](const Call&) { return Action{}; });
  REQUIRE(whole.code == 0);
  CHECK(difference(place.files("broken"), unbroken).empty());
  for (const long call : calls_to_kill(whole.calls, early, late)) {
    INFO("killed at call " << call << " of about " << whole.calls);
    CHECK(kill_and_resume(place, call, unbroken) == "");
  }
}

}  // namespace

TEST_CASE("I53: a run that is killed at any system call is resumed to the same files") {
  check_kills(FaultyRun("--threads 2 --set /parts/0/density=500 --fps 50", "--obj --quiet"), 12, 24);
}
TEST_CASE("I53: a run with a checkpoint after each step is resumed to the same files") {
  check_kills(FaultyRun("--end 0.04", "--checkpoint-every 0 --quiet"), 6, 18);
}
TEST_CASE("I53: a run that draws pictures is resumed to the same files") {
  check_kills(FaultyRun("--end 0.03 --size 40x30", "--png --quiet"), 4, 8);
}
TEST_CASE("I53: a run is resumed to the same files from each of its first 600 system calls", "[.extended]") {
  check_kills(FaultyRun("--threads 2 --set /parts/0/density=500 --tolerance 1e-5", "--obj --quiet"), 600, 0);
}
TEST_CASE("I53: a run is resumed to the same files from 500 later system calls", "[.extended]") {
  check_kills(FaultyRun("--threads 2 --set /parts/0/density=500 --tolerance 1e-5", "--obj --quiet"), 0, 500);
}
TEST_CASE("I53: a run with --force that is killed leaves the old run whole, or continues as the new one") {
  if (!tracing_works()) return;
  const FaultyRun place("--end 0.05");
  const std::string replace_options = "--set /parts/0/density=500", replace = "--force " + replace_options;
  REQUIRE(place.run("old", "--obj") == 0);
  REQUIRE(place.run("new", replace) == 0);
  const auto old_files = place.files("old"), new_files = place.files("new");
  place.copy("old", "broken");
  long begins = 0, ends = 0;  // the calls between which the program uses the folder
  place.traced(
      "broken", replace,
      [&](const Call& call) {
        if (begins == 0 && call.path.find("broken") != std::string::npos) begins = call.number;
        ends = call.number;
        return Action{};
      },
      true);
  REQUIRE(begins > 0);
  long kept = 0;
  for (long i = 0; i <= 40; ++i) {
    place.copy("old", "broken");
    const long at = begins + (ends - begins) * i * i / 1600;  // most of them at the beginning
    INFO("killed at call " << at << " of about " << ends);
    place.traced("broken", replace, [at](const Call& call) { return Action{call.number == at, 0}; });
    const fs::path folder = place / "broken";
    const bool begun = fs::exists(folder / "new_run.whole") || fs::exists(folder / "new_run.moving") ||
                       !fs::exists(folder / "meshes");
    if (!begun) ++kept;
    CHECK(place.run("broken", begun ? replace_options + " --resume" : "--resume --obj") == 0);
    CHECK(difference(place.files("broken"), begun ? new_files : old_files) == "");
  }
  CHECK(kept > 5);
  CHECK(kept < 40);
}

}  // namespace kill_test
