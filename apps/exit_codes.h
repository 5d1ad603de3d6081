// Exit codes of the program, as its help describes them.
#pragma once

namespace pliant_cli {

enum ExitCode {
  kDone = 0,
  kInternal = 1,
  kCommandLine = 2,
  kInput = 3,
  kUnsatisfiable = 4,  // joints contradict each other
  kNumerical = 5,
  kBoundExceeded = 6,  // the run is complete, but the error of its energy balance is large
  kFileSystem = 7,
  kResources = 8,
  kWouldOverwrite = 9,
  kRecordingMismatch = 10,  // the recording does not match the scene or the program, or is damaged
  kSignal = 128,            // plus the number of the signal
};

inline constexpr const char* kExitCodesHelp =
    "Exit codes: 0 done, 1 internal error, 2 command line, 3 input, 4 joints contradict each other,\n"
    "5 numerical failure, 6 energy balance worse than 1 %, 7 file system,\n"
    "8 resources (memory, graphics), 9 would overwrite files,\n"
    "10 recording does not match the scene or program, or is damaged,\n"
    "128 + N stopped by signal N (continue with --resume).";

}  // namespace pliant_cli
