// System calls on the files of a run fail. The run ends with code 7 and a message, or does not need the call.
// Resumed, it gives the files of an unbroken run.
#include <algorithm>
#include <cerrno>

#include <sys/syscall.h>

#include "catch.h"
#include "faulty_run.h"

namespace failing_calls_test {

using namespace faults;

namespace {

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// Returns the errors that a kind of call can report.
std::vector<int> errors_of(long what) {
  switch (what) {
    case SYS_write:
    case SYS_pwrite64:
      return {ENOSPC, EIO, EINTR, EDQUOT};
    case SYS_fsync:
      return {EIO, ENOSPC, EINTR};
    case SYS_openat:
      return {EMFILE, EACCES, ENOSPC, EROFS, EINTR};
    case SYS_ftruncate:
      return {EIO, EINTR};
    case SYS_pread64:
    case SYS_read:
      return {EIO, EINTR};
    case SYS_close:
      return {EIO, ENOSPC};
    case SYS_flock:
      return {ENOLCK, EOPNOTSUPP, EINTR};
    case SYS_mkdir:
      return {ENOSPC, EACCES, EROFS};
    case SYS_rename:
      return {EIO, ENOSPC};
    case SYS_unlink:
    case SYS_rmdir:
      return {EIO, EROFS};
    default:
      return {};
  }
}

/// Lets one call of a run fail, and resumes the run. Returns what is wrong; empty if all is right.
std::string fail_and_resume(const FaultyRun& place, long call, int error,
                            const std::map<std::string, std::string>& unbroken) {
  fs::remove_all(place / "broken");
  const Ended ended = place.traced("broken", "", [&](const Call& now) {
    return Action{false, now.number == call ? error : 0};
  });
  const std::string told = place.output();
  if (error == EINTR && ended.code != 0) return "not repeated: " + told;
  if (ended.code != 0 && ended.code != 7) return "code " + std::to_string(ended.code) + ": " + told;
  if (ended.code == 7 && !has(told, "pliant: error: ")) return "no message: " + told;
  const bool locks = error == ENOLCK || error == EOPNOTSUPP;  // only the lock of the folder is necessary
  if (locks && ended.code == 7 && !has(told, "does not lock files")) return "the lock is not named: " + told;
  return place.wrong_after_resume("broken", unbroken);
}

/// Lets one call fail while the killed run is resumed, and resumes it again. Returns what is wrong.
std::string fail_while_resumed(const FaultyRun& place, long call, int error,
                               const std::map<std::string, std::string>& unbroken) {
  place.copy("killed", "broken");
  const Ended ended = place.traced("broken", "--resume", [&](const Call& now) {
    return Action{false, now.number == call ? error : 0};
  });
  const std::string told = place.output();
  if (error == EINTR && ended.code != 0) return "not repeated: " + told;
  if (ended.code != 0 && ended.code != 7) return "code " + std::to_string(ended.code) + ": " + told;
  return place.wrong_after_resume("broken", unbroken);
}

/// Returns calls on files of a run, each with an error that it can report.
std::vector<std::pair<long, int>> possible_faults(const FaultyRun& place, const std::string& more) {
  std::vector<std::pair<long, int>> faults;
  place.traced(
      "broken", more,
      [&](const Call& call) {
        if (has(call.path, "broken"))
          for (const int error : errors_of(call.what)) faults.emplace_back(call.number, error);
        return Action{};
      },
      true);
  return faults;
}

/// Lets about `count` of the calls on files of a run fail, each in one run.
void check_failures(const std::string& options, const std::string& outputs, std::size_t count) {
  if (!tracing_works()) return;
  const FaultyRun place(options, outputs);
  REQUIRE(place.run("unbroken") == 0);
  const auto unbroken = place.files("unbroken");
  const std::vector<std::pair<long, int>> faults = possible_faults(place, "");
  REQUIRE(faults.size() > 100);
  const std::size_t stride = std::max<std::size_t>(1, faults.size() / count);
  for (std::size_t i = 0; i < faults.size(); i += stride) {
    INFO("call " << faults[i].first << " failed with error " << faults[i].second);
    CHECK(fail_and_resume(place, faults[i].first, faults[i].second, unbroken) == "");
  }
}

}  // namespace

TEST_CASE("I51: a call on a file that fails ends the run with code 7, and the run can be resumed") {
  check_failures("--end 0.02 --threads 1", "--obj --quiet", 40);
}
TEST_CASE(
    "I51: if the disk is full, --force keeps the old run, or the new one has begun and can be resumed") {
  if (!tracing_works()) return;
  const FaultyRun place("--end 0.02");
  const std::string replace = "--force --set /parts/0/density=500";
  REQUIRE(place.run("old") == 0);
  REQUIRE(place.run("new", replace) == 0);
  const auto old_files = place.files("old"), new_files = place.files("new");
  place.copy("old", "broken");
  std::vector<long> full;  // calls that fail with ENOSPC
  for (const auto& [call, error] : possible_faults(place, replace))
    if (error == ENOSPC) full.push_back(call);
  REQUIRE(full.size() > 40);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < full.size(); i += full.size() / 40) {
    place.copy("old", "broken");
    INFO("no space on the disk from call " << full[i] << " on");
    const Ended ended = place.traced(
        "broken", replace,
        [&](const Call& now) {
          const bool needs_space = now.what == SYS_write || now.what == SYS_pwrite64 ||
                                   now.what == SYS_fsync || now.what == SYS_mkdir;
          return Action{false, now.number >= full[i] && needs_space && has(now.path, "broken") ? ENOSPC : 0};
        },
        true);
    INFO(place.output());
    CHECK((ended.code == 7 || ended.code == 0));  // 0: the last calls need not succeed
    if (difference(place.files("broken"), old_files).empty()) {
      ++kept;
      continue;
    }
    CHECK(place.resume("broken") == 0);
    CHECK(difference(place.files("broken"), new_files) == "");
  }
  CHECK(kept > 5);
}
TEST_CASE("I51: a call on a file may fail while a run is resumed, and the run can be resumed again") {
  if (!tracing_works()) return;
  const FaultyRun place("--end 0.04", "--checkpoint-every 0 --quiet");
  REQUIRE(place.run("unbroken") == 0);
  const auto unbroken = place.files("unbroken");
  const long calls = place.traced("killed", "", [](const Call&) { return Action{}; }).calls;
  fs::remove_all(place / "killed");
  place.traced("killed", "", [&](const Call& now) { return Action{now.number == calls * 3 / 4, 0}; });
  REQUIRE(fs::exists(place / "killed/checkpoint_2.npy"));
  place.copy("killed", "broken");
  const std::vector<std::pair<long, int>> faults = possible_faults(place, "--resume");
  REQUIRE(faults.size() > 60);
  for (std::size_t i = 0; i < faults.size(); i += faults.size() / 40) {
    INFO("call " << faults[i].first << " failed with error " << faults[i].second);
    CHECK(fail_while_resumed(place, faults[i].first, faults[i].second, unbroken) == "");
  }
}
TEST_CASE("I51: a parent folder that cannot be read does not prevent a run") {
  if (!tracing_works()) return;
  const FaultyRun place("--end 0.01");
  bool refused = false;
  const Ended ended = place.traced(
      "r", "",
      [&](const Call& call) {
        const bool parent = call.what == SYS_openat && call.path == ".";
        refused = refused || parent;
        return Action{false, parent ? EACCES : 0};
      },
      true);
  INFO(place.output());
  CHECK(refused);
  CHECK(ended.code == 0);
}
TEST_CASE("I51: each of 600 calls on files may fail, and the run can be resumed", "[.extended]") {
  check_failures("--end 0.05 --threads 1", "--obj --checkpoint-every 0 --quiet", 600);
}

}  // namespace failing_calls_test
