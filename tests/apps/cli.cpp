// The program `pliant` as a separate process: exit codes, messages, files in folders, and signals.
// I47 to I59 and N42 in names of tests are rows of the tables in tests/README.md.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "program.h"

namespace cli_test {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using test::has;
using test::kTop;
using test::Result;
using test::TestFolder;

namespace {

// Starts a run of 100 000 s. Waits until the run has recorded its first states, at most 12 s. Returns the
// number of the process.
pid_t start_long_run(const TestFolder& place, const std::string& run) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::chdir(place.folder.path.c_str()) != 0) ::_exit(99);
    ::execl(PLIANT_PROGRAM, "pliant", "run", "top.json", "--end", "100000", "-o", run.c_str(), "--quiet",
            nullptr);
    ::_exit(99);
  }
  for (int i = 0; i < 600; ++i) {
    std::error_code ignored;
    if (fs::file_size(place.folder / (run + "/t.npy"), ignored) > 200 && !ignored) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return child;
}

// Waits for the end of a process. Returns its exit code, or minus the number of the signal that ended it.
int exit_code_of(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace

TEST_CASE("help and version are printed, and a run writes its files") {
  const TestFolder place;
  for (const char* command :
       {"", "run ", "check ", "info ", "list ", "view ", "render ", "export ", "schema ", "doctor "}) {
    const Result help = place.pliant(std::string(command) + "--help");
    CHECK(help.code == 0);
    CHECK(has(help.out, "pliant"));
    CHECK(help.err.empty());
  }
  const Result version = place.pliant("--version");
  CHECK(version.code == 0);
  for (const char* word : {"pliant ", "compiler ", "eigen ", "SuiteSparse", "GPL", "libpng"})
    CHECK(has(version.out, word));

  const Result run = place.pliant("run top.json --obj");
  CHECK(run.code == 0);
  CHECK(place.record("out/top").at("status") == "complete");
  for (const char* file : {"layout.json", "scene.json", "trajectory.csv", "meshes/frame_000000.obj",
                           "meshes/frame_000012.obj", "meshes/parts.mtl"})
    CHECK(fs::exists(place.folder / ("out/top/" + std::string(file))));
  CHECK_FALSE(fs::exists(place.folder / "out/top/meshes/frame_000013.obj"));
  CHECK_FALSE(fs::exists(place.folder / "out/top/frames"));
}

TEST_CASE(
    "run --estimate-error prints errors, or is refused if no run can be more accurate; auto names its "
    "method") {
  const TestFolder place;
  const Result run = place.pliant(
      "run top.json --end 0.05 --integrator auto --tolerance 1e-6 --estimate-error --quiet -o out/e");
  CHECK(run.code == 0);
  CHECK(has(run.out, "largest differences from a more accurate run with a tolerance of 1e-07\n  position "));
  CHECK(has(place.record("out/e").dump(), "integrator dop853: dop853 advances "));
  CHECK(place.record("out/e").at("error_estimate").at("rotation") > 0);
  const Result best = place.pliant("run top.json --tolerance 1e-12 --estimate-error -o out/best");
  CHECK(best.code == 3);
  CHECK(has(best.err, "the error of a run with the tolerance 1e-12 cannot be estimated"));
  CHECK(!fs::exists(place.folder / "out/best"));
}

TEST_CASE("commands that print information exit with 0 and write no files") {
  const TestFolder place;
  const Result info = place.pliant("info top.json");
  CHECK(info.code == 0);
  for (const char* words :
       {"7 degrees of freedom", "mass ", "inertia", "rule \"", "skipped", "largest stable step: about"})
    CHECK(has(info.out, words));
  CHECK(has(info.out, "1 part, "));
  CHECK_FALSE(has(info.out, "e-1"));  // rounding errors are shown as zero
  CHECK(has(place.pliant("info top.json --set /time/step=10").out, "warning"));
  const Result check = place.pliant("check top.json");
  CHECK(check.code == 0);
  CHECK(has(check.out, "500 steps"));
  for (const char* kind : {"shapes", "deformations", "laws", "joints", "integrators", "functions"}) {
    const Result list = place.pliant(std::string("list ") + kind);
    CHECK(list.code == 0);
    CHECK(list.out.size() > 100);
  }
  const Result schema = place.pliant("schema");
  CHECK(Json::parse(schema.out).contains("properties"));
  CHECK(schema.out == bytes_of(fs::path(PLIANT_SCENES) / "pliant-scene.schema.json"));
  // The folder contains top.json and the captured output (.out, .err) only.
  CHECK(std::distance(fs::directory_iterator(place.folder.path), fs::directory_iterator()) == 3);
}

TEST_CASE("info reports joints: rows, rank, islands, and the size of the factor") {
  const TestFolder place;
  const auto info = [&](const std::string& arguments) {
    const Result result = place.pliant("info " + arguments);
    CHECK(result.code == 0);
    INFO(arguments);
    CHECK(result.err.empty());
    return result.out;
  };
  // Four hinges in a loop. The factor has blocks of 5 x 5 numbers: four on the diagonal and three below the
  // diagonal, without fill-in.
  const std::string scenes = PLIANT_SCENES;
  const std::string linkage = info("'" + scenes + "/four_bar.json'");
  CHECK(has(linkage,
            "constraints: 20 rows of rank 17, 1 island, 1 solved by blocks of C_q M^-1 C_q^T, "
            "175 numbers in the factor\n"));
  CHECK(has(linkage, "implied by those of other joints: 3 rows of 1 joint"));
  const std::string augmented = info("'" + scenes + "/four_bar.json' --set /time/solver=augmented");
  CHECK(has(augmented, "constraints: 20 rows of rank 17, 1 island, 1 solved with the augmented matrix, "));
  CHECK(has(info("'" + scenes + "/n_four_bar.json'"), "constraints: 35 rows of rank 29, 1 island, "));
  // A pendulum and a double pendulum are two islands.
  set_bytes(place.folder / "two.json", R"({
    "parts": [{"name": "a", "shape": "sphere", "position": [0, 0, -1]},
              {"name": "b", "shape": "sphere", "position": [5, 0, -1]},
              {"name": "c", "shape": "sphere", "position": [5, 0, -3]}],
    "joints": [{"type": "ball", "from": {"world": [0, 0, 0]},
                "to": {"part": "a", "at": {"u": 1.5707963267948966, "v": 0}}},
               {"type": "ball", "from": {"world": [5, 0, 0]},
                "to": {"part": "b", "at": {"u": 1.5707963267948966, "v": 0}}},
               {"type": "ball", "from": {"part": "b", "at": {"u": -1.5707963267948966, "v": 0}},
                "to": {"part": "c", "at": {"u": 1.5707963267948966, "v": 0}}}]
  })");
  const std::string two = info("two.json");
  CHECK(has(two,
            "constraints: 9 rows of rank 9, 2 islands, 2 solved by blocks of C_q M^-1 C_q^T, 36 numbers "
            "in the factors of all islands\n"));
  CHECK_FALSE(has(two, "redundant"));
}

TEST_CASE("I47: command line errors end with code 2 and a hint") {
  const TestFolder place;
  const auto mistake = [&](const std::string& arguments, const std::string& words) {
    const Result result = place.pliant(arguments);
    CHECK(result.code == 2);
    INFO(arguments << ": " << result.err);
    CHECK(has(result.err, words));
    CHECK(result.out.empty());
    CHECK_FALSE(fs::exists(place.folder / "out"));
  };
  mistake("", "[OPTIONS] SUBCOMMAND");
  mistake("", "pliant info scenes/pull.json                     parts");
  mistake("rn top.json", "did you mean \"run\"");
  mistake("run top.json --obk", "did you mean \"--obj\"");
  mistake("run top.json --stp=0.1", "did you mean \"--step\"");
  mistake("run top.json --step", "--step");
  mistake("run", "scene");
  for (const char* bad : {"abc", "1e-3s", "0,001", "-1", "0", "nan", "inf", "1e400", "0x10"})
    mistake(std::string("run top.json --step=") + bad, "is not a number > 0");
  mistake("run top.json --end=-1", "is not a number >= 0");
  mistake("run top.json --end 1 --end 2", "--end");
  mistake("run top.json --threads 1.5", "whole number");
  mistake("run top.json --size 640", "640x480");
  mistake("run top.json --size 99999x1", "8192");
  mistake("run top.json --force --resume", "excludes");
  mistake("run top.json second.json", "second.json");
  mistake("list shape", "shapes");
  mistake("export out --to stl", "stl");
  mistake("render", "run");
  mistake("run top.json -q", "there is no option -q\n");
  mistake("render out --frames 5:2", "END must be above FIRST");
  mistake("export out --to obj --frames 1:2:0", "FIRST:END:STRIDE");
  mistake("render out --shard 3/2", "1 <= i <= n");
  mistake("render out --fov 200", "is not a number from 5 to 120");
  mistake("doctor -o nowhere", "nowhere");
}

TEST_CASE("I47: numbers do not depend on the locale") {
  const TestFolder place;
  CHECK(place.pliant("run top.json --end 0.1 --quiet -o a", "LC_ALL=de_DE.UTF-8").code == 0);
  CHECK(place.pliant("run top.json --end 0.1 --quiet -o b").code == 0);
  CHECK(place.motion("a") == place.motion("b"));
}

TEST_CASE("I48: standard input, names that begin with a dash, names with blanks and accents") {
  const TestFolder place;
  CHECK(place.pliant("run - --end 0.1 --quiet < top.json").code == 0);
  CHECK(place.record("out/scene").at("status") == "complete");
  CHECK(place.pliant("export out/scene --to obj --quiet --frames 0").code == 0);
  fs::copy_file(place.folder / "top.json", place.folder / "-dash.json");
  CHECK(place.pliant("run --end 0.1 --quiet -o dash -- -dash.json").code == 0);
  fs::copy_file(place.folder / "top.json", place.folder / "größer als.json");
  CHECK(place.pliant("run 'größer als.json' --end 0.1 --quiet").code == 0);
  CHECK(fs::exists(place.folder / "out/größer als/run.json"));
}

TEST_CASE("input errors end with code 3 before a folder is created") {
  const TestFolder place;
  const Result missing = place.pliant("run tip.json");
  CHECK(missing.code == 3);
  CHECK(has(missing.err, "did you mean \"top.json\""));
  const Result wrong = place.pliant("run top.json --set /parts/0/densiti=3 --set /time/step=-1");
  CHECK(wrong.code == 3);
  CHECK(has(wrong.err, "did you mean \"density\""));
  CHECK(has(wrong.err, "/time/step"));
  const Result model = place.pliant("check top.json --set '/parts/0/parameters/a1=-1'");
  CHECK(model.code == 3);
  const Result machine = place.pliant("check top.json --set /parts/0/densiti=3 --diagnostics json");
  CHECK(machine.code == 3);
  CHECK(Json::parse(machine.out).at("errors") == 1);
  CHECK_FALSE(fs::exists(place.folder / "out"));
  CHECK(place.pliant("render nowhere").code == 3);
}

TEST_CASE("bad scenes: code 3, the expected message on standard error, and no other output") {
  const TestFolder place;
  for (const std::string name :
       {"empty", "not_utf8", "gzip", "faults_of_all_kinds", "folded_bend", "frame_rate_absurd"}) {
    fs::copy_file(fs::path(PLIANT_BAD_SCENES) / (name + ".json"), place.folder / (name + ".json"));
    for (const std::string command : {"check ", "run ", "info "}) {
      INFO(command << name);
      const Result result = place.pliant(command + name + ".json");
      CHECK(result.code == 3);
      CHECK(result.out.empty());
      CHECK(result.err == bytes_of(fs::path(PLIANT_BAD_SCENES) / (name + ".txt")));
    }
  }
  CHECK_FALSE(fs::exists(place.folder / "out"));
}

TEST_CASE("a step that is too large gives a warning, then code 5; the good part of the recording is kept") {
  const TestFolder place;
  const Result result = place.pliant("run top.json --step 2 --end 4000 -o r");
  CHECK(result.code == 5);
  CHECK(has(result.err, "warning"));
  CHECK(has(result.err, "largest stable"));
  CHECK(place.record("r").at("status") == "failed");
  CHECK(fs::exists(place.folder / "r/trajectory.csv"));
}

TEST_CASE("I49, I50: existing files are not overwritten") {
  const TestFolder place;
  REQUIRE(place.pliant("run top.json -o r --quiet").code == 0);
  const std::string motion = place.motion("r");
  CHECK(place.pliant("run top.json -o r --quiet").code == 9);
  for (const char* option : {"", " --force"}) {
    const Result file = place.pliant(std::string("run top.json -o top.json") + option);
    CHECK(file.code == 9);
    CHECK(has(file.err, "the output folder top.json is a file; choose another name with -o"));
  }
  const Result no_run = place.pliant("run top.json -o top.json --resume");
  CHECK(no_run.code == 3);
  CHECK(has(no_run.err, "there is no run"));
  fs::create_directory(place.folder / "other");
  set_bytes(place.folder / "other/letter.txt", "dear");
  for (const char* option : {"", " --force", " --resume"}) {
    const Result other = place.pliant(std::string("run top.json -o other") + option);
    CHECK(other.code == 9);
    CHECK(has(other.err, "the output folder other is not empty"));
    CHECK(has(other.err, "choose another with -o"));
  }
  CHECK(bytes_of(place.folder / "other/letter.txt") == "dear");
  CHECK(place.pliant("run r/scene.json -o r --force").code == 9);
  CHECK(place.pliant("run top.json -o . --force").code == 9);
  CHECK(bytes_of(place.folder / "top.json") == kTop);
  CHECK(place.motion("r") == motion);
  CHECK(place.pliant("run top.json -o r/ --quiet --force").code == 0);
  CHECK(place.motion("r") == motion);
  CHECK(place.pliant("export r --to obj --quiet --frames 3").code == 0);
  CHECK(place.pliant("export r --to obj --quiet").code == 9);
  CHECK_FALSE(fs::exists(place.folder / "r/meshes/frame_000000.obj"));
  CHECK(place.pliant("export r --to obj --quiet --force").code == 0);
  CHECK(place.pliant("export r --to ply --quiet --shard 2/2 -o p").code == 0);
  CHECK(fs::exists(place.folder / "p/frame_000001.ply"));
  CHECK_FALSE(fs::exists(place.folder / "p/frame_000000.ply"));
  CHECK(place.pliant("export r --to ply --frames 5:99").code == 3);
  CHECK(place.pliant("export r --to ply --quiet --frames 1 -o p --force --color-by strain").code == 0);
  CHECK(has(bytes_of(place.folder / "p/frame_000001.ply"), "property double strain"));
}

TEST_CASE("options for colouring by values must be complete and valid") {
  const TestFolder place;
  CHECK(place.pliant("run top.json --color-by stain").code == 2);
  CHECK(place.pliant("run top.json --color-range 0 1").code == 2);
  const Result falls = place.pliant("run top.json --color-by strain --color-range 1 1");
  CHECK(falls.code == 2);
  CHECK(has(falls.err, "--color-range"));
  CHECK_FALSE(fs::exists(place.folder / "out"));
}

TEST_CASE("I51: a run that cannot write its files ends with code 7, and can be resumed") {
  const TestFolder place;
  // No file may have more than 40 blocks of 512 bytes. The tables of the run soon exceed this limit; run.json
  // and scene.json do not.
  const Result result = place.pliant("run top.json --fps 1000 --end 2 -o r --quiet", "ulimit -f 40;");
  CHECK(result.code == 7);
  CHECK(has(result.err, "cannot write"));
  CHECK(place.record("r").at("status") == "failed");
  CHECK_FALSE(fs::exists(place.folder / "r/trajectory.csv"));
  for (const fs::directory_entry& entry : fs::directory_iterator(place.folder / "r"))
    CHECK_FALSE(has(entry.path().string(), ".part-"));
  CHECK(place.pliant("run top.json -o r --quiet --resume").code == 0);
  REQUIRE(place.pliant("run top.json --fps 1000 --end 2 -o unbroken --quiet").code == 0);
  CHECK(place.motion("r") == place.motion("unbroken"));
  if (fs::exists("/dev/full")) CHECK(place.pliant("list shapes > /dev/full #").code == 7);
  if (::geteuid() != 0) {
    fs::create_directory(place.folder / "readonly");
    fs::permissions(place.folder / "readonly", fs::perms::owner_read | fs::perms::owner_exec);
    CHECK(place.pliant("run top.json -o readonly/r").code == 7);
  }
}

TEST_CASE("I52: after a signal the run ends in an orderly way, and can be resumed to identical files") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const TestFolder place;
    const pid_t child = start_long_run(place, "r");
    ::kill(child, signal);
    CHECK(exit_code_of(child) == 128 + signal);
    const Json record = place.record("r");
    CHECK(record.at("status") == "stopped");
    CHECK_FALSE(fs::exists(place.folder / "r/pliant.lock"));
    CHECK(fs::exists(place.folder / "r/trajectory.csv"));
    const std::string end = std::to_string(record.at("progress").at("time").get<double>() + 0.75);
    CHECK(place.pliant("run top.json -o r --quiet --resume --end " + end).code == 0);
    REQUIRE(place.pliant("run top.json -o unbroken --quiet --end " + end).code == 0);
    CHECK(place.motion("r") == place.motion("unbroken"));
  }
}

TEST_CASE("I53: after a kill the run can be resumed to identical files") {
  const TestFolder place;
  const pid_t child = start_long_run(place, "r");
  ::kill(child, SIGKILL);
  CHECK(exit_code_of(child) == -SIGKILL);
  CHECK(place.record("r").at("status") == "running");
  CHECK(place.pliant("export r --to obj --quiet --frames 0 -o m").code == 0);
  const std::string times = bytes_of(place.folder / "r/t.npy");
  double last = 0;
  std::memcpy(&last, times.data() + (times.size() - 8), sizeof last);
  const std::string end = std::to_string(last + 0.75);
  CHECK(place.pliant("run top.json -o r --quiet --resume --end " + end).code == 0);
  REQUIRE(place.pliant("run top.json -o unbroken --quiet --end " + end).code == 0);
  CHECK(place.motion("r") == place.motion("unbroken"));
}

TEST_CASE("I55: a run is not resumed if its scene, options or files do not match: code 10") {
  const TestFolder place;
  REQUIRE(place.pliant("run top.json -o r --quiet").code == 0);
  CHECK(place.pliant("run top.json -o r --resume --set /parts/0/density=5").code == 10);
  CHECK(place.pliant("run top.json -o r --resume --step 0.002").code == 10);
  CHECK(place.pliant("run top.json -o r --resume --fps 30").code == 10);
  CHECK(place.pliant("run top.json -o nothing --resume").code == 3);
  std::string scene = bytes_of(place.folder / "r/scene.json");
  set_bytes(place.folder / "r/scene.json", scene + " ");
  CHECK(place.pliant("export r --to obj").code == 10);
  set_bytes(place.folder / "r/scene.json", scene);
  std::string q = bytes_of(place.folder / "r/q.npy");
  q.back() = static_cast<char>(q.back() ^ 1);
  set_bytes(place.folder / "r/q.npy", q);
  const Result flipped = place.pliant("run top.json -o r --resume");
  CHECK(flipped.code == 10);
  CHECK(has(flipped.err, "r/q.npy is damaged at row 13: its checksum does not match"));
}

TEST_CASE("a recording that lost states after its run ended is reported, and can be completed") {
  const TestFolder place;
  REQUIRE(place.pliant("run top.json -o r --quiet").code == 0);
  const std::string motion = place.motion("r"), q = bytes_of(place.folder / "r/q.npy");
  set_bytes(place.folder / "r/q.npy", q.substr(0, q.size() / 2));
  const Result cut = place.pliant("export r --to obj --quiet");
  CHECK(cut.code == 10);
  CHECK(has(cut.err, "--resume"));
  CHECK_FALSE(fs::exists(place.folder / "r/meshes"));
  CHECK(place.pliant("run top.json -o r --quiet --resume").code == 0);
  CHECK(place.motion("r") == motion);
  set_bytes(place.folder / "r/run.json", "{");
  const Result damaged = place.pliant("export r --to obj");
  CHECK(damaged.code == 10);
  CHECK_FALSE(has(damaged.err, "json.exception"));
}

TEST_CASE("too many frames for files are refused before the simulation, and need no memory without files") {
  const TestFolder place;
  const Result files = place.pliant("run top.json --fps 1e9 --obj");
  CHECK(files.code == 3);
  CHECK(has(files.err, "at most 1000000"));
  CHECK_FALSE(fs::exists(place.folder / "out"));
#ifdef PLIANT_SANITIZED
  const std::string memory_limit;  // the sanitizer itself reserves terabytes of addresses
#else
  const std::string memory_limit = "ulimit -d 500000;";  // kB
#endif
  CHECK(place.pliant("run top.json --fps 1e9 --end 0.1 --quiet", memory_limit).code == 0);
}

TEST_CASE("I57: a closed standard output causes no crash") {
  const TestFolder place;
  const Result piped = place.pliant("run top.json -o r 2>&1 | true; echo done");
  CHECK(piped.code == 0);
  const Result list = place.pliant("list shapes | head -1; true");
  CHECK(list.code == 0);
}

TEST_CASE("I58: a second run in the same folder is refused while the first is running") {
  const TestFolder place;
  const pid_t child = start_long_run(place, "r");
  for (const char* how : {"", "--force", "--resume"}) {
    const Result second = place.pliant(std::string("run top.json -o r ") + how);
    CHECK(second.code == 9);
    if (*how != 0) CHECK(has(second.err, "in use by another run (process " + std::to_string(child)));
  }
  ::kill(child, SIGINT);
  CHECK(exit_code_of(child) == 128 + SIGINT);
}

TEST_CASE("I59: a scene without parts, and a run without duration") {
  const TestFolder place;
  set_bytes(place.folder / "empty.json", R"({"parts": []})");
  CHECK(place.pliant("run empty.json --obj --quiet").code == 0);
  CHECK(place.record("out/empty").at("status") == "complete");
  CHECK(fs::exists(place.folder / "out/empty/meshes/frame_000000.obj"));
  CHECK(place.pliant("info empty.json").code == 0);
  CHECK(place.pliant("run top.json --end 0 --quiet").code == 0);
}

TEST_CASE("scripts print chains and nets of any size, and print their usage on errors") {
  const TestFolder place;
  const std::string scenes = PLIANT_SCENES;
  for (const char* script : {"chain.sh' 1", "chain.sh' 20", "net.sh' 3 3", "net.sh' 4 7"}) {
    INFO(script);
    const Result check = place.pliant("check -", "bash '" + scenes + "/" + script + " |");
    CHECK(check.code == 0);
    CHECK(has(check.out, "ok: "));
    CHECK(check.err.empty());
  }
  for (const char* script :
       {"chain.sh'", "chain.sh' 0", "chain.sh' -3", "chain.sh' 2 2", "chain.sh' many", "net.sh'", "net.sh' 5",
        "net.sh' 2 5", "net.sh' 4 4.5", "pour.sh'", "pour.sh' 0"}) {
    INFO(script);
    const std::string file = (place.folder / "usage").string();
    const int status =
        std::system(("bash '" + scenes + "/" + script + " > '" + file + ".out' 2> '" + file + "'").c_str());
    CHECK(WEXITSTATUS(status) == 2);
    CHECK(has(bytes_of(file), "usage: "));
    CHECK(bytes_of(file + ".out").empty());
  }
}

TEST_CASE("no graphics library is opened unless a picture is requested") {
  const TestFolder place;
  const Result run = place.pliant("run top.json -o r --obj", "LD_DEBUG=files");
  CHECK(run.code == 0);
  CHECK(has(run.err, "libpng"));  // LD_DEBUG lists the loaded libraries
  for (const char* library : {"OSMesa", "libEGL", "libGL", "libLLVM"}) CHECK_FALSE(has(run.err, library));
}

TEST_CASE("a scene changed on the command line is also used for rendering and export") {
  const TestFolder place;
  REQUIRE(place.pliant("run top.json -o r --quiet --set /parts/0/name=fish --end 0.1 --fps 20").code == 0);
  CHECK(place.pliant("export r --to obj --quiet").code == 0);
  CHECK(has(bytes_of(place.folder / "r/meshes/frame_000002.obj"), "g fish\n"));
  CHECK_FALSE(fs::exists(place.folder / "r/meshes/frame_000003.obj"));
}

TEST_CASE("pictures from a run and from its recording are identical") {
  const TestFolder place;
  const Result run = place.pliant("run top.json -o r --quiet --png --fps 6");
  if (run.code == 8) return;  // this machine has no graphics library
  REQUIRE(run.code == 0);
  const std::string picture = bytes_of(place.folder / "r/frames/frame_000002.png");
  CHECK(picture.substr(1, 3) == "PNG");
  CHECK(place.pliant("render r --quiet -o again --frames 2").code == 0);
  CHECK(bytes_of(place.folder / "again/frame_000002.png") == picture);
  CHECK(place.pliant("render r --quiet").code == 9);
  CHECK(place
            .pliant("render r --quiet -o other --frames 2 --size 80x60 --camera-eye -1 -2.5 .5 "
                    "--camera-target 0 0 0")
            .code == 0);
  CHECK(bytes_of(place.folder / "other/frame_000002.png") != picture);
  CHECK(place.record("r").at("files").dump().find("frames/frame_*.png") != std::string::npos);
  CHECK(has(place.record("r").at("options").at("graphics"), "OpenGL"));
  // The camera looks straight down. The options switch off springs, ground and shadows.
  CHECK(place
            .pliant(
                "render r --quiet -o above --frames 2 --camera-eye 0 0 3 --camera-target 0 0 0 --no-springs "
                "--no-ground --no-shadows")
            .code == 0);
  CHECK(fs::exists(place.folder / "above/frame_000002.png"));
}

TEST_CASE(
    "N42: joints that contradict each other end a run with code 4 and their names, also with error control") {
  const TestFolder place;
  set_bytes(place.folder / "apart.json", R"({
    "gravity": [0, 0, 0],
    "time": {"end": 3, "step": 0.001, "integrator": "rk4"},
    "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.2}}],
    "joints": [{"type": "ball", "name": "here", "from": {"world": [0, 0, 0]},
                "to": {"part": "ball", "at": {"u": 0, "v": 0, "w": 0}}},
               {"type": "ball", "name": "there", "from": {"world": [1, 0, 0]},
                "to": {"part": "ball", "at": {"u": 0, "v": 0, "w": 0}}}]
  })");
  for (const char* time :
       {R"({"end": 3, "step": 0.001, "integrator": "rk4"})", R"({"end": 3, "tolerance": 1e-6})",
        R"({"end": 3, "integrator": "esdirk", "tolerance": 1e-6})"}) {
    INFO(time);
    const Result run = place.pliant(std::string("run apart.json -o out --force --set '/time=") + time + "'");
    CHECK(run.code == 4);
    CHECK(has(run.err, "ball 'there' stays open by 1 m"));
    CHECK(has(run.err, "'here'"));
    CHECK(place.record("out")["status"] == "failed");
  }
  // If the run ends before the contradiction is detected, the open joint is reported.
  const Result early = place.pliant("run apart.json -o out --force --end 0.5");
  CHECK(early.code == 0);
  CHECK(has(early.err, "ball 'there', by 1 m"));
  CHECK(place.record("out")["monitors"]["open_gap"] == 1);
}

TEST_CASE("frames of a run with a tolerance are drawn and exported") {
  const TestFolder place;
  REQUIRE(place.pliant("run top.json -o out --tolerance 1e-6 --end 0.1").code == 0);
  CHECK(place.pliant("export out --to obj -o meshes").code == 0);
  CHECK(fs::exists(place.folder / "meshes/frame_000002.obj"));
}

TEST_CASE("names of ten thousand letters are shortened in messages, whose ends are complete") {
  const TestFolder place;
  const std::string name(10000, 'n');
  for (const std::string& arguments : {"run top.json --" + name + "=3", "run top.json -o " + name,
                                       "check top.json --set /" + name + "=3", "check " + name + ".json"}) {
    const Result result = place.pliant(arguments);
    CHECK(result.code != 0);
    CHECK(result.err.size() < 1200);
    CHECK(has(result.err, "nnn...nnn"));
  }
  const Result key = place.pliant("check top.json --set /" + name + "=3");
  CHECK(key.code == 3);
  CHECK(has(key.err, "unknown key; expected one of \"name\", \"description\", "));
  CHECK(has(key.err, "\"ground\"\n"));
  const Result path = place.pliant("check " + name + ".json");
  CHECK(path.code == 7);
  CHECK(has(path.err, "nnn.json"));
  CHECK(has(path.err, "File name too long\n"));
}

TEST_CASE("empty keys, text after the scene and impossible shards are refused") {
  const TestFolder place;
  for (const std::string& text :
       {std::string(R"({"parts": [{"name": "a", "shape": "sphere"}], "": 3})"),
        std::string("{\"parts\": [{\"name\": \"a\", \"shape\": \"sphere\"}]}\0 {}", 49)}) {
    set_bytes(place.folder / "odd.json", text);
    const Result odd = place.pliant("check odd.json");
    CHECK(odd.code == 3);
    CHECK(has(odd.err, "odd.json:1:"));
    CHECK((has(odd.err, "/: unknown key") || has(odd.err, "\"\\x00\" after the end of the document")));
  }
  const Result set = place.pliant("check top.json --set /=5");
  CHECK(set.code == 3);
  CHECK(has(set.err, "unknown key"));
  const Result shard = place.pliant("render out --shard 9999999999/9999999999 -o x");
  CHECK(shard.code == 2);
  CHECK(has(shard.err, "has more shards than a recording has frames; expected at most 1000000"));
}

}  // namespace cli_test
