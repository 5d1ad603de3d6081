// The steps of a run, the numbers of the steps after which states are recorded, and the selection of frames.
// I33, N24, N28 and N30 in names of tests are rows of the tables in tests/README.md.
#include <pliant/io/frame_schedule.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "catch.h"

#include <pliant/io/frame_range.h>

namespace frame_schedule_test {

using namespace pliant;

TEST_CASE("N28: steps fill the run, and the last step ends at the end of the run") {
  const FrameSchedule one_second(1, 1e-3, 25);
  CHECK(one_second.steps() == 1000);
  CHECK(one_second.step() == 1e-3);
  CHECK(one_second.end() == 1);
  CHECK(one_second.frames() == 26);
  const FrameSchedule third(1, 0.3, 25);
  CHECK(third.steps() == 4);
  CHECK(third.step() == 0.25);
  CHECK(third.end() == 1);
  const FrameSchedule rounded(0.3, 0.1, 10);  // 0.3 / 0.1 is 2.9999999999999996
  CHECK(rounded.steps() == 3);
  CHECK(rounded.step() == 0.1);
  const FrameSchedule kept = FrameSchedule::with_exact_step(1, 0.3, 25);
  CHECK(kept.steps() == 4);
  CHECK(kept.step() == 0.3);
  const FrameSchedule none(0, 0.1, 25);
  CHECK(none.steps() == 0);
  CHECK(none.frames() == 1);
  CHECK(none.records(0));
}

TEST_CASE("I33, N24: invalid or extreme values of end, step and frame rate are refused") {
  const double nan = std::nan("");
  for (const double bad : {0.0, -1.0, nan, HUGE_VAL}) {
    CHECK_THROWS_AS(FrameSchedule(1, bad, 25), std::invalid_argument);
    CHECK_THROWS_AS(FrameSchedule(1, 0.1, bad), std::invalid_argument);
  }
  for (const double bad : {-1.0, nan, HUGE_VAL})
    CHECK_THROWS_AS(FrameSchedule(bad, 0.1, 25), std::invalid_argument);
  CHECK_THROWS_AS(FrameSchedule(1, 1e-300, 25), std::invalid_argument);
  CHECK_THROWS_AS(FrameSchedule(1, 0.1, 1e300), std::invalid_argument);
}

TEST_CASE("N30: a frame is at a recorded state, or between the recorded states at both ends of a step") {
  for (const double step : {1e-3, 0.0007, 0.01, 0.4, 1.0 / 3})
    for (const double rate : {1.0, 24.0, 25.0, 60.0, 1000.0, 2999.0}) {
      const FrameSchedule schedule(1.3, step, rate);
      std::set<std::int64_t> recorded;
      for (std::int64_t i = 0; i <= schedule.steps(); ++i)
        if (schedule.records(i)) recorded.insert(i);
      CHECK(recorded.count(0) == 1);
      CHECK(recorded.count(schedule.steps()) == 1);
      std::set<std::int64_t> needed{0, schedule.steps()};
      for (std::int64_t k = 0; k < schedule.frames(); ++k) {
        const double place = schedule.frame_time(k) / schedule.step();
        if (std::abs(place - std::round(place)) < 1e-6) {
          needed.insert(std::llround(place));
        } else {
          needed.insert(static_cast<std::int64_t>(std::floor(place)));
          needed.insert(static_cast<std::int64_t>(std::ceil(place)));
        }
      }
      CHECK(recorded == needed);
    }
}

TEST_CASE("ranges of frames are parsed, and divided into shards") {
  const auto frames = [](const std::string& text) { return FrameRange::parse(text).frames(10); };
  CHECK(frames(":").size() == 10);
  CHECK(frames("2:5:2") == std::vector<std::int64_t>{2, 4});
  CHECK(frames("7") == std::vector<std::int64_t>{7});
  CHECK(frames("::4") == std::vector<std::int64_t>{0, 4, 8});
  CHECK(frames("8:") == std::vector<std::int64_t>{8, 9});
  for (const char* bad : {"", "a", "1:2:0", "-1", "1:2:3:4", "1.5", " 1", "0:5:-1", "5:3", "5:5"})
    CHECK_THROWS_AS(FrameRange::parse(bad), std::invalid_argument);
  for (const char* beyond : {"10", "0:11", "12:"}) CHECK_THROWS_AS(frames(beyond), std::invalid_argument);
  // Numbers of frames above the limit are refused before memory is allocated.
  constexpr std::int64_t limit = FrameRange::kMaxFrames, many = 1000000000000;
  CHECK(FrameRange().size(limit) == limit);
  CHECK_THROWS_AS(FrameRange().frames(limit + 1), std::invalid_argument);
  CHECK_THROWS_AS(FrameRange().frames(many), std::invalid_argument);
  CHECK(FrameRange::parse("::9223372036854775807").frames(many) == std::vector<std::int64_t>{0});
  FrameRange few = FrameRange::parse(":");
  few.parse_shard("7/1000000");
  CHECK_THROWS_AS(few.parse_shard("7/1000001"), std::invalid_argument);
  CHECK(few.frames(10) == std::vector<std::int64_t>{6});
  CHECK(few.frames(5).empty());
  std::set<std::int64_t> all;
  for (int i = 1; i <= 3; ++i) {
    FrameRange range = FrameRange::parse("1::2");
    range.parse_shard(std::to_string(i) + "/3");
    for (const std::int64_t k : range.frames(10)) CHECK(all.insert(k).second);
  }
  CHECK(all == std::set<std::int64_t>{1, 3, 5, 7, 9});
  FrameRange range;
  for (const char* bad : {"0/2", "3/2", "1", "1/2/3", "a/2", "1/"})
    CHECK_THROWS_AS(range.parse_shard(bad), std::invalid_argument);
}

}  // namespace frame_schedule_test
