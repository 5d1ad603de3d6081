// The commands of the program. Each function declares a command and its options. When the command line is
// parsed, the selected command sets the action.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pliant_cli {

/// The action of a command line. The action returns an exit code, and throws exceptions that failure.h
/// reports.
using Action = std::function<int()>;

/// command_line: the words of the command line, which the run writes to run.json.
void add_run(CLI::App& app, Action& action, const std::vector<std::string>& command_line);
void add_check(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_list(CLI::App& app, Action& action);
void add_render(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
void add_schema(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_view(CLI::App& app, Action& action);

}  // namespace pliant_cli
