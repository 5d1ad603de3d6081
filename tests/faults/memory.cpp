// From some allocation on, all allocations of memory fail. The program ends with code 8 and a message, and
// the folder of the run stays usable.
#include <algorithm>

#include "catch.h"
#include "faulty_run.h"

namespace memory_test {

using namespace faults;

namespace {

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// Runs the program; all allocations from the one with the number `from` on fail. Returns the exit code.
int run_without_memory(const FaultyRun& place, const std::string& run, long from) {
  return place.run(run, "",
                   "LD_PRELOAD='" PLIANT_FAIL_MEMORY "' PLIANT_COUNT_MEMORY=.count PLIANT_FAIL_MEMORY_FROM=" +
                       std::to_string(from));
}

/// Checks `points` runs. In each run, all allocations from a certain number on fail. These numbers are spread
/// over the whole run.
void check_exhaustion(const FaultyRun& place, long points) {
  REQUIRE(place.run("whole") == 0);
  const auto whole = place.files("whole");
  REQUIRE(run_without_memory(place, "r", 1L << 60) == 0);
  const long all = std::stol(bytes_of(place / ".count"));
  REQUIRE(all > 1000);
  for (long i = 0; i < points; ++i) {
    const long from = 1 + all * i / points;
    fs::remove_all(place / "r");
    INFO("no memory from allocation " << from << " of " << all << " on");
    const int code = run_without_memory(place, "r", from);
    CHECK(code == 8);
    CHECK(has(place.output(), "out of memory"));
    CHECK(place.resume("r") == 0);
    CHECK(difference(place.files("r"), whole) == "");
  }
}

}  // namespace

TEST_CASE("out of memory, at any allocation: code 8, and the folder stays usable") {
  check_exhaustion(FaultyRun("--end 0.05 --threads 2", "--obj --quiet"), 40);
}
TEST_CASE("out of memory in the graphics library: code 8, and the folder stays usable") {
  check_exhaustion(FaultyRun("--end 0.02 --size 32x24", "--png --quiet"), 12);
}
TEST_CASE("out of memory, at any of 100 allocations of a long run: code 8", "[long]") {
  check_exhaustion(FaultyRun("--threads 2 --tolerance 1e-5", "--obj --quiet"), 100);
}
TEST_CASE("out of memory, at any of 600 allocations of a long run: code 8", "[.extended]") {
  check_exhaustion(FaultyRun("--threads 2 --tolerance 1e-5", "--obj --quiet"), 600);
}
TEST_CASE("a picture that needs more memory than the process can have is refused before the simulation") {
  const FaultyRun place("", "--png");
  CHECK(place.run("r", "--size 8192x8192", "ulimit -v 3500000;") == 8);
  CHECK(has(place.output(), "a picture of 8192 x 8192 pixels needs about 4.27 GB of memory"));
  CHECK(has(place.output(), "the limit of its address space, ulimit -v"));
  CHECK_FALSE(fs::exists(place / "r"));
  CHECK(place.run("r", "--end 0 --size 64x48", "ulimit -v 3500000;") == 0);
}
TEST_CASE("a system that refuses threads gives the same files with fewer threads") {
  const FaultyRun place("--end 0.05");
  REQUIRE(place.run("whole") == 0);
  // The stack of a thread is larger than the address space.
  REQUIRE(place.run("r", "--threads 3", "ulimit -s 4000000; ulimit -v 2000000;") == 0);
  CHECK(difference(place.files("r"), place.files("whole")) == "");
}

}  // namespace memory_test
