// Scenes of many parts: memory and processor time per part, from the start of the program to its end.
#include <algorithm>
#include <string>

#include <sys/resource.h>

#include "catch.h"
#include "program.h"

namespace large_test {

using test::Result;
using test::TestFolder;

namespace {

/// Writes a scene of n equal rigid spheres without gravity, which runs for five steps.
void write_scene(const TestFolder& place, int n) {
  std::string text =
      R"({"gravity": [0, 0, 0], "time": {"end": 0.005, "step": 0.001, "integrator": "rk4"}, "parts": [)";
  for (int i = 0; i < n; ++i)
    text += (i == 0 ? "" : ",\n") + (R"({"name": "p)" + std::to_string(i)) + R"(", "shape": "sphere"})";
  set_bytes(place.folder / "large.json", text + "]}");
}

/// Memory (bytes) of the largest child process that has ended, and processor time (s) of all of them.
struct Usage {
  double bytes, seconds;
};
Usage usage_of_children() {
  rusage usage;
  REQUIRE(::getrusage(RUSAGE_CHILDREN, &usage) == 0);
  auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {1024.0 * static_cast<double>(usage.ru_maxrss), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

}  // namespace

// Measured: see "Many parts" in bench/README.md.
TEST_CASE("memory and time of a scene grow by little for each equal part", "[long]") {
  constexpr int n = 100'000;
  constexpr double max_bytes = 4000, max_seconds = 150e-6;  // per part
  const TestFolder place;
  write_scene(place, n);
  for (const char* command : {"check large.json", "run large.json --quiet -o out"}) {
    const Usage before = usage_of_children();
    const Result result = place.pliant(command);
    const Usage after = usage_of_children();
    INFO(command << ": " << after.bytes / n << " bytes and " << (after.seconds - before.seconds) * 1e6 / n
                 << " us per part; " << result.err);
    CHECK(result.code == 0);
    CHECK(after.bytes / n <= max_bytes);
    CHECK((after.seconds - before.seconds) / n <= max_seconds);
  }
}

}  // namespace large_test
