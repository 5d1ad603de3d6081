// Conversion of exceptions to a message on standard error and an exit code.
#pragma once

#include <functional>
#include <stdexcept>

#include <CLI/CLI.hpp>

namespace pliant_cli {

/// Thrown if a resource of the machine, for example a graphics library, is missing. The exit code is 8.
class ResourceFailure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Runs a task and returns its exit code. If the task throws an exception, prints the message on standard
/// error and returns the exit code for this exception (exit_codes.h).
int reporting_failures(const std::function<int()>& task);

/// From now on the program ends at once with a message and exit code 8 if it cannot allocate memory, also
/// where no exception can pass, for example in a destructor of a library. A run can then be resumed.
void end_if_memory_is_exhausted();

/// Prints on standard error why a command line cannot be parsed, and returns kCommandLine (exit_codes.h). If
/// the command line asks for help or the version, prints the answer on standard output and returns kDone.
int report_parse_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace pliant_cli
