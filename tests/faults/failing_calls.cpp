// System calls on the files of a run fail. The run ends with code 7 and a message, or does not need the call.
// The resumed run gives the files of an uninterrupted run.
// I51 in the name of a test is a row of the table in tests/README.md.
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

/// A failing call on a file of a run.
struct Fault {
  long call = 0;
  int error = 0;
  std::string file;  ///< the name of the file
};

/// Returns a description of the wrong exit code or message of a run that could not lock a file, or an empty
/// text. Only the lock of the folder is necessary.
std::string wrong_without_lock(const std::string& file, int code, const std::string& output) {
  if (file == "pliant.lock")
    return code == 7 && has(output, "does not lock files") ? "" : "the lock is not named: " + output;
  return code == 0 && has(file, ".part-") ? "" : "code " + std::to_string(code) + ": " + output;
}

/// Returns a description of the wrong exit code of a run in which a call failed with `error`, or an empty
/// text. output: the text of the program.
std::string wrong_code(int error, int code, const std::string& output) {
  if (error == EINTR && code != 0) return "the program did not repeat the interrupted call: " + output;
  return code == 0 || code == 7 ? "" : "code " + std::to_string(code) + ": " + output;
}

/// Makes one call of a run fail, and resumes the run. Returns a description of the first wrong result, or an
/// empty text.
std::string fail_and_resume(const FaultyRun& place, const Fault& fault,
                            const std::map<std::string, std::string>& unbroken) {
  fs::remove_all(place / "broken");
  const int error = fault.error;
  const Ended ended = place.traced("broken", "", [&](const Call& now) {
    return Action{false, now.number == fault.call ? error : 0};
  });
  const std::string told = place.output();
  const std::string wrong_end = wrong_code(error, ended.code, told);
  if (!wrong_end.empty()) return wrong_end;
  if (ended.code == 7 && !has(told, "pliant: error: ")) return "no message: " + told;
  if (error == ENOLCK || error == EOPNOTSUPP) {
    const std::string wrong = wrong_without_lock(fault.file, ended.code, told);
    if (!wrong.empty()) return wrong;
  }
  return place.wrong_after_resume("broken", unbroken);
}

/// Makes one call fail while the run in the folder "killed" is resumed, and resumes the run again. Returns a
/// description of the first wrong result, or an empty text.
std::string fail_while_resumed(const FaultyRun& place, const Fault& fault,
                               const std::map<std::string, std::string>& unbroken) {
  place.copy("killed", "broken");
  const Ended ended = place.traced("broken", "--resume", [&](const Call& now) {
    return Action{false, now.number == fault.call ? fault.error : 0};
  });
  const std::string told = place.output();
  const std::string wrong = wrong_code(fault.error, ended.code, told);
  if (!wrong.empty()) return wrong;
  return place.wrong_after_resume("broken", unbroken);
}

/// Returns calls on files of a run, each with an error that the call can report.
std::vector<Fault> possible_faults(const FaultyRun& place, const std::string& more) {
  std::vector<Fault> faults;
  place.traced(
      "broken", more,
      [&](const Call& call) {
        if (has(call.path, "broken"))
          for (const int error : errors_of(call.what))
            faults.push_back({call.number, error, fs::path(call.path).filename().string()});
        return Action{};
      },
      true);
  return faults;
}

/// Makes about `count` of the calls on files of a run fail, one call in each run. Checks that the resumed
/// runs give the files of an uninterrupted run.
void check_failures(const std::string& options, const std::string& outputs, std::size_t count) {
  if (!tracing_works()) return;
  const FaultyRun place(options, outputs);
  REQUIRE(place.run("unbroken") == 0);
  const auto unbroken = place.files("unbroken");
  const std::vector<Fault> faults = possible_faults(place, "");
  REQUIRE(faults.size() > 100);
  const std::size_t stride = std::max<std::size_t>(1, faults.size() / count);
  for (std::size_t i = 0; i < faults.size(); i += stride) {
    INFO("call " << faults[i].call << " on " << faults[i].file << " failed with error " << faults[i].error);
    CHECK(fail_and_resume(place, faults[i], unbroken) == "");
  }
}

}  // namespace

TEST_CASE("I51: a run with a failing call on a file ends with code 7 or is complete, and can be resumed") {
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
  for (const Fault& fault : possible_faults(place, replace))
    if (fault.error == ENOSPC) full.push_back(fault.call);
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
  const std::vector<Fault> faults = possible_faults(place, "--resume");
  REQUIRE(faults.size() > 60);
  for (std::size_t i = 0; i < faults.size(); i += faults.size() / 40) {
    INFO("call " << faults[i].call << " on " << faults[i].file << " failed with error " << faults[i].error);
    CHECK(fail_while_resumed(place, faults[i], unbroken) == "");
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
