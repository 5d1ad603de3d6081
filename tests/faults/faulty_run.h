// Runs of the program `pliant` that are broken by faults, resumed, and compared with an unbroken run.
#pragma once

#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "io/new_folder.h"
#include "traced_process.h"

namespace faults {

namespace fs = std::filesystem;

/// A scene. A ball bounces on a plane, and a ball joint connects it to a second ball. A third ball is at rest
/// on the plane, and a twisted body spins. Every table of the run has rows.
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

/// Returns the text of run.json without the entries that a resumed run may change: wall times, the command
/// line, the number of threads, the number of resumes, the number of factorisations, notes on resuming, and
/// the checksum of run.json.
inline std::string lasting_record(const std::string& text) {
  nlohmann::json record = nlohmann::json::parse(text);
  record.erase("wall_seconds");
  record.erase("check");
  record.at("options").erase("command");
  record.at("options").erase("threads");
  record.at("progress").erase("resumed");
  record.at("work").erase("factorisations");
  std::vector<std::string> notes;
  for (const std::string note : record.at("notes")) {
    bool on_resuming = false;
    for (const char* words : {"the run starts at time 0", "the run continues from an earlier state",
                              "it is written again", "are simulated again"})
      on_resuming = on_resuming || note.find(words) != std::string::npos;
    if (!on_resuming) notes.push_back(note);
  }
  record["notes"] = notes;
  return record.dump(1);
}

/// Returns the first lines that differ in two texts.
inline std::string first_difference(const std::string& text, const std::string& expected) {
  std::istringstream lines(text), expected_lines(expected);
  std::string line, expected_line;
  while (std::getline(expected_lines, expected_line)) {
    if (!std::getline(lines, line)) line = "nothing";
    if (line != expected_line) return " (" + line + " instead of " + expected_line + ")";
  }
  return " at its end";
}

/// Returns a description of the differences between the files of two runs, or an empty text.
inline std::string difference(const std::map<std::string, std::string>& files,
                              const std::map<std::string, std::string>& expected) {
  std::string text;
  for (const auto& [name, bytes] : expected) {
    const auto found = files.find(name);
    if (found == files.end())
      text += name + " is missing; ";
    else if (found->second != bytes)
      text += name + " differs" + (name == "run.json" ? first_difference(found->second, bytes) : "") + "; ";
  }
  for (const auto& entry : files)
    if (expected.count(entry.first) == 0) text += entry.first + " is left over; ";
  return text;
}

/// Returns whether system calls can be traced; warns if they cannot.
inline bool tracing_works() {
  if (can_trace()) return true;
  WARN("skipped: this system does not let a process trace its children");
  return false;
}

/// A folder with a scene, in which the program runs.
class FaultyRun {
 public:
  /// options: options of `pliant run` that a resumed run reads from its folder. outputs: options that are
  /// given again when the run is resumed. The options --resume and --force are in neither text.
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
  /// Runs `pliant verify` for a run and returns the exit code.
  int verify(const std::string& run) const { return shell("'" PLIANT_PROGRAM "' verify " + run); }
  /// Runs the program under ptrace, see run_traced(). output() then returns the output of this command.
  Ended traced(const std::string& run, const std::string& more,
               const std::function<Action(const Call&)>& at_call, bool with_paths = false) const {
    std::vector<std::string> words{PLIANT_PROGRAM, "run", "bounce.json", "-o", run};
    std::istringstream options(options_ + " " + outputs_ + " " + more);
    for (std::string word; options >> word;) words.push_back(word);
    return run_traced(words, folder_.path.string(), (folder_ / ".out").string(), with_paths, at_call);
  }
  /// Resumes a run that was broken, and compares its files with those of an unbroken run. Returns a
  /// description of the differences, or an empty text.
  std::string wrong_after_resume(const std::string& run,
                                 const std::map<std::string, std::string>& unbroken) const {
    const int code = resume(run);
    if (code != 0) return "the resumed run ended with " + std::to_string(code) + ": " + output();
    return difference(files(run), unbroken) + left_beside(run);
  }
  /// Replaces the folder `to` by a copy of the folder `from`, which contains a run.
  void copy(const std::string& from, const std::string& to) const {
    fs::remove_all(folder_ / to);
    fs::copy(folder_ / from, folder_ / to, fs::copy_options::recursive);
  }
  /// Returns the output of the last command.
  std::string output() const { return bytes_of(folder_ / ".out"); }
  fs::path operator/(const std::string& name) const { return folder_ / name; }

  /// Returns the name of an unfinished folder that a killed process has left beside the folder of a run, or
  /// an empty text.
  std::string left_beside(const std::string& run) const {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path))
      if (entry.path().filename().string().rfind(run + ".part-", 0) == 0) return entry.path().string();
    return {};
  }
  /// Returns the names of all files of a run, with their bytes. For run.json the bytes are lasting_record().
  std::map<std::string, std::string> files(const std::string& run) const {
    std::map<std::string, std::string> all;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / run)) {
      const std::string name = entry.path().lexically_relative(folder_ / run).string();
      if (entry.is_directory())
        all[name];
      else
        all[name] = name == "run.json" ? lasting_record(bytes_of(entry.path())) : bytes_of(entry.path());
    }
    return all;
  }

 private:
  int program(const std::string& arguments, const std::string& before) const {
    return shell(before + " '" PLIANT_PROGRAM "' run bounce.json " + arguments);
  }
  int shell(const std::string& command) const {
    const std::string line = "cd '" + folder_.path.string() + "' && " + command + " > .out 2>&1";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  NewFolder folder_;
  std::string options_, outputs_;
};

}  // namespace faults
