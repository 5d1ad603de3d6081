// The folder of a run in which an earlier process was killed: unfinished files are removed, and a beginning
// that was not completed is completed or started again.
// I53 in the name of a test is a row of the table in tests/README.md.
#include <pliant/io/run/run_folder.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "catch.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/io/run/run.h>
#include <pliant/io/run/run_files.h>

namespace run_folder_test {

using namespace pliant;
namespace fs = std::filesystem;

namespace {

constexpr const char* kFiles[] = {kTimesFile, kCoordinatesFile, kVelocitiesFile,
                                  kModesFile, kChecksumsFile,   kTrajectoryFile};

/// Holds the lock of a file, like a process that writes the file.
struct HeldLock {
  explicit HeldLock(const fs::path& file) : descriptor(::open(file.c_str(), O_RDWR)) {
    REQUIRE(::flock(descriptor, LOCK_EX | LOCK_NB) == 0);
  }
  ~HeldLock() { ::close(descriptor); }
  HeldLock(const HeldLock&) = delete;
  HeldLock& operator=(const HeldLock&) = delete;
  int descriptor;
};

/// Collects the notes for the user.
struct Notes : Progress {
  std::string all;
  void note(const std::string& text) override { all += text + "\n"; }
};

/// Runs a scene to its end, and returns the notes.
std::string run(const fs::path& folder, Existing existing) {
  const auto scene = free_top();
  RunOptions options;
  options.folder = folder;
  options.existing = existing;
  options.threads = 1;
  Notes notes;
  Run session(*scene, options, notes);
  session.simulate();
  session.finish(RunRecord::Status::complete);
  return notes.all;
}

/// Returns the bytes of all tables of a run.
std::string results_of(const fs::path& folder) {
  std::string bytes;
  for (const char* file : kFiles) bytes += bytes_of(folder / file);
  return bytes;
}

/// Returns the number of a process that has ended.
int ended_process() {
  return 999999998;  // above the largest number of a process
}

}  // namespace

TEST_CASE("I53: a folder with leftovers of a run that had not begun is used again, with a note") {
  const NewFolder folder;
  run(folder / "good", Existing::refuse);
  const std::string ended = std::to_string(ended_process());
  for (const Existing existing : {Existing::refuse, Existing::force, Existing::resume}) {
    const fs::path out = folder / ("r" + std::to_string(static_cast<int>(existing)));
    fs::create_directories(out / ("new_run.part-" + ended + "-0"));
    set_bytes(out / ("new_run.part-" + ended + "-0") / kTimesFile, "half");
    set_bytes(out / kLockFile, ended);
    set_bytes(out / kNewRunFile, "{}");
    set_bytes(out / (std::string(kNewRunFile) + ".part-1-0"), "half");
    CHECK(run(out, existing).find("no run had begun") != std::string::npos);
    CHECK(results_of(out) == results_of(folder / "good"));
    for (const fs::directory_entry& entry : fs::directory_iterator(out)) {
      const std::string name = entry.path().filename().string();
      INFO(name);
      CHECK(name.find("part-") == std::string::npos);
      CHECK(name.find("new_run") == std::string::npos);
    }
  }
}

TEST_CASE(
    "I53: a beginning that was interrupted after its first renaming is completed, and replaces the old run") {
  const NewFolder folder;
  run(folder / "new", Existing::refuse);
  for (const char* stage : {kWholeNewRun, kMovingNewRun}) {
    const fs::path out = folder / stage;
    fs::create_directories(out / kMeshFolder);
    set_bytes(out / kRunFile, "old");
    set_bytes(out / kMeshFolder / "frame_000000.obj", "old");
    set_bytes(out / "notes.txt", "mine");
    fs::copy(folder / "new", out / stage);
    if (std::string(stage) == kMovingNewRun) {  // the old files are removed already, and one file is moved
      fs::remove_all(out / kMeshFolder);
      fs::remove(out / kRunFile);
      fs::rename(out / stage / kTimesFile, out / kTimesFile);
    }
    CHECK(find_run_file(out) == out / stage / kRunFile);
    CHECK_THROWS_AS(run(out, Existing::refuse), OutputRefused);
    run(out, Existing::resume);
    CHECK(results_of(out) == results_of(folder / "new"));
    CHECK_FALSE(fs::exists(out / stage));
    CHECK_FALSE(fs::exists(out / kMeshFolder));
    CHECK(bytes_of(out / "notes.txt") == "mine");
  }
}

TEST_CASE(
    "the lock of an unfinished folder decides whether it is removed, and not the number of its process") {
  const NewFolder folder;
  const fs::path alive = folder / ("r.part-" + std::to_string(ended_process()) + "-0"),
                 killed = folder / ("r.part-" + std::to_string(::getppid()) + "-0"),
                 empty = folder / ("r.part-" + std::to_string(::getppid()) + "-1");
  for (const fs::path& unfinished : {alive, killed, empty}) fs::create_directory(unfinished);
  set_bytes(alive / kLockFile, "1");
  set_bytes(killed / kLockFile, "1");
  set_bytes(killed / kNewRunFile, "{}");
  const HeldLock run_elsewhere(alive / kLockFile);
  run(folder / "r", Existing::refuse);
  CHECK(fs::exists(alive));
  CHECK_FALSE(fs::exists(killed));
  CHECK_FALSE(fs::exists(empty));
}

TEST_CASE("unfinished files are removed, but not frames that a living process writes") {
  const NewFolder folder;
  const fs::path out = folder / "r";
  run(out, Existing::refuse);
  const std::string ended = std::to_string(ended_process()), living = std::to_string(::getppid());
  fs::create_directory(out / kFrameFolder);
  const fs::path locked = out / kFrameFolder / ("frame_000003.png.part-" + ended + "-0"),
                 stale = out / kFrameFolder / ("frame_000001.png.part-" + ended + "-0"),
                 fresh = out / kFrameFolder / ("frame_000002.png.part-" + living + "-0"),
                 other = out / kFrameFolder / ("cat.png.part-" + ended + "-0"),
                 table = out / ("trajectory.csv.part-" + living + "-0"),
                 beside = folder / ("r.part-" + ended + "-0"), mine = folder / ("r.part-" + ended + "-1");
  for (const fs::path& file : {locked, stale, fresh, other, table}) set_bytes(file, "x");
  const HeldLock writer(locked);  // like the lock of a process on another machine
  for (const fs::path& unfinished : {beside, mine}) {
    fs::create_directory(unfinished);
    set_bytes(unfinished / kLockFile, ended);
  }
  set_bytes(mine / "letter.txt", "dear");
  run(out, Existing::resume);
  CHECK_FALSE(fs::exists(stale));
  CHECK(fs::exists(fresh));
  CHECK(fs::exists(locked));
  CHECK(fs::exists(other));
  CHECK_FALSE(fs::exists(table));  // only a run with the lock writes this file
  fs::remove_all(out);
  run(out, Existing::refuse);
  CHECK_FALSE(fs::exists(beside));
  CHECK(fs::exists(mine));
}

}  // namespace run_folder_test
