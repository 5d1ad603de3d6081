// Runs of the program `pliant` that are broken by faults, resumed, and compared with an unbroken run.
#pragma once

#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "io/new_folder.h"
#include "traced_process.h"

namespace faults {

namespace fs = std::filesystem;

/// A ball bounces on a plane, with a second one on a ball joint, beside a ball at rest and a twisted body.
/// All tables of the run have rows.
inline const char* const kBounce = R"({
  "time": {"end": 0.3, "step": 0.002, "integrator": "rk4"},
  "parts": [
    {"name": "ball", "shape": "sphere", "parameters": {"r": 0.1}, "position": [0, 0, 0.12],
     "velocity": [0.3, 0, -1], "resolution": 1},
    {"name": "tail", "shape": "sphere", "parameters": {"r": 0.1}, "position": [0, 0.2, 0.12],
     "velocity": [0.3, 0, -1], "resolution": 1},
    {"name": "stone", "shape": "sphere", "parameters": {"r": 0.1}, "position": [0, -1, 0.1], "resolution": 1},
    {"name": "top", "shape": "ellipsoid", "deformations": ["twist"], "position": [1, 0, 1],
     "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.1, "twist.angle": {"rest": 0.1, "stiffness": 100}},
     "angular_velocity": [1, 0.1, 2], "resolution": 1}],
  "joints": [{"name": "link", "type": "ball", "from": {"part": "ball", "at": {"u": 0, "v": 1.5707963}},
              "to": {"part": "tail", "at": {"u": 0, "v": -1.5707963}}}],
  "contact": {"planes": [{"name": "floor", "normal": [0, 0, 1]}]},
  "output": {"frame_rate": 100, "size": [32, 24], "contacts": true}
})";

/// A folder with a scene, in which the program runs.
class FaultyRun {
 public:
  /// options: of `pliant run`, without those that resume or replace a run. outputs: those that a resumed run
  /// needs again.
  explicit FaultyRun(std::string options, std::string outputs = "--quiet")
      : options_(std::move(options)), outputs_(std::move(outputs)) {
    set_bytes(folder_ / "bounce.json", kBounce);
  }

  /// Runs the program to the end in the folder `run`, with more options. before: text of the shell command in
  /// front of the program. Returns the exit code.
  int run(const std::string& run, const std::string& more = "", const std::string& before = "") const {
    return program("-o " + run + " " + options_ + " " + outputs_ + " " + more, before);
  }
  /// Resumes a run without repeating its options, or runs it again if there is no folder of the run. Returns
  /// the exit code.
  int resume(const std::string& run) const {
    return fs::exists(folder_ / run) ? program("-o " + run + " " + outputs_ + " --resume", "")
                                     : this->run(run);
  }
  /// Runs the program under ptrace, see run_traced(). Its output is that of the last command.
  Ended traced(const std::string& run, const std::string& more,
               const std::function<Action(const Call&)>& at_call, bool with_paths = false) const {
    std::vector<std::string> words{PLIANT_PROGRAM, "run", "bounce.json", "-o", run};
    std::istringstream options(options_ + " " + outputs_ + " " + more);
    for (std::string word; options >> word;) words.push_back(word);
    return run_traced(words, folder_.path.string(), (folder_ / ".out").string(), with_paths, at_call);
  }
  /// Returns the output of the last command.
  std::string output() const { return bytes_of(folder_ / ".out"); }
  fs::path operator/(const std::string& name) const { return folder_ / name; }

  /// Returns the name of a folder beside that of a run that a killed process has left; empty if there is
  /// none.
  std::string left_beside(const std::string& run) const {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path))
      if (entry.path().filename().string().rfind(run + ".part-", 0) == 0) return entry.path().string();
    return {};
  }
  /// Returns the names of all files of a run, with their bytes; without bytes for run.json, which contains
  /// times.
  std::map<std::string, std::string> files(const std::string& run) const {
    std::map<std::string, std::string> all;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / run)) {
      const std::string name = entry.path().lexically_relative(folder_ / run).string();
      all[name] = name == "run.json" || entry.is_directory() ? "" : bytes_of(entry.path());
    }
    return all;
  }

 private:
  int program(const std::string& arguments, const std::string& before) const {
    const std::string line = "cd '" + folder_.path.string() + "' && " + before +
                             " '" PLIANT_PROGRAM "' run bounce.json " + arguments + " > .out 2>&1";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  NewFolder folder_;
  std::string options_, outputs_;
};

/// Returns what differs between the files of two runs, for the message of a test; empty if nothing differs.
inline std::string difference(const std::map<std::string, std::string>& files,
                              const std::map<std::string, std::string>& expected) {
  std::string text;
  for (const auto& [name, bytes] : expected) {
    const auto found = files.find(name);
    if (found == files.end())
      text += name + " is missing; ";
    else if (found->second != bytes)
      text += name + " differs; ";
  }
  for (const auto& entry : files)
    if (expected.count(entry.first) == 0) text += entry.first + " is left over; ";
  return text;
}

}  // namespace faults
