// From exceptions to a message on standard error and an exit code.
#pragma once

#include <functional>
#include <stdexcept>

#include <CLI/CLI.hpp>

namespace pliant_cli {

/// The machine lacks something (a graphics library): exit code 8.
class ResourceFailure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Runs a task; every exception ends here.
int reporting_failures(const std::function<int()>& task);

/// The same for a command line that could not be parsed; help and version come this way too, with code 0.
int report_parse_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace pliant_cli
