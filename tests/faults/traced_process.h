// A process that runs under ptrace. All system calls of all its threads are counted, and the process can be
// killed at one of them, or one of them can fail.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace faults {

/// A system call that is about to start.
struct Call {
  long number = 0;   ///< the number of the call in the process, from 1
  long what = 0;     ///< the kind: SYS_write, ...
  std::string path;  ///< the file, if the call has a path or a descriptor of a file; otherwise empty
};

/// What happens at a call: nothing, SIGKILL, or failure with a value of errno.
struct Action {
  bool kill = false;
  int error = 0;
};

/// How a traced process ended.
struct Ended {
  bool traced = false;  ///< false if the system refuses ptrace; the process then did not run
  int code = -1;        ///< exit code, or 128 + the number of the signal that ended the process
  long calls = 0;       ///< number of system calls
};

/// Runs a command in a folder and returns how it ended. The standard output and standard error of the command
/// are written to the file `output`. at_call: decides what happens at a call. with_paths: whether Call::path
/// is needed, which takes time.
Ended run_traced(const std::vector<std::string>& command, const std::string& folder,
                 const std::string& output, bool with_paths,
                 const std::function<Action(const Call&)>& at_call);

/// Returns whether this system lets a process trace its children, and calls can be made to fail.
bool can_trace();

}  // namespace faults
