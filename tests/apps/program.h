// The program `pliant` as a separate process that runs in a folder of its own.
#pragma once

#include <cstdlib>
#include <string>

#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include "io/new_folder.h"

namespace test {

/// The scene top.json: a spinning ellipsoid with a dynamic twist.
inline const char* const kTop = R"({
  "gravity": [0, 0, 0],
  "time": {"end": 0.5, "step": 0.001, "integrator": "rk4"},
  "parts": [{"name": "top", "shape": "ellipsoid", "deformations": ["twist"],
             "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.1, "twist.angle": {"rest": 0.1, "stiffness": 100}},
             "angular_velocity": [1, 0.1, 2], "velocity": [0.2, 0, 0], "resolution": 2}],
  "output": {"size": [64, 48]}
})";

/// Exit code and captured output of a run of the program.
struct Result {
  int code = -1;
  std::string out, err;
};

/// A new folder that contains the scene top.json. The program runs in this folder.
struct TestFolder {
  NewFolder folder;
  TestFolder() { set_bytes(folder / "top.json", kTop); }

  /// Runs the program in a shell and returns its exit code and output. before: text of the shell command in
  /// front of the program, for example settings of environment variables.
  Result pliant(const std::string& arguments, const std::string& before = "") const {
    const std::string line = "cd '" + folder.path.string() + "' && " + before + " '" + PLIANT_PROGRAM + "' " +
                             arguments + " > .out 2> .err";
    const int status = std::system(("LC_ALL=C " + line).c_str());
    Result result;
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = bytes_of(folder / ".out");
    result.err = bytes_of(folder / ".err");
    return result;
  }
  /// Returns run.json of the run in a folder.
  nlohmann::json record(const std::string& run) const {
    return nlohmann::json::parse(bytes_of(folder / (run + "/run.json")));
  }
  /// Returns the bytes of the recording and of the trajectory of a run.
  std::string motion(const std::string& run) const {
    std::string bytes;
    for (const char* file : {"t.npy", "q.npy", "v.npy", "modes.npy", "trajectory.csv"})
      bytes += bytes_of(folder / (run + "/" + file));
    return bytes;
  }
};

inline bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

}  // namespace test
