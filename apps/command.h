// A command of the program: it declares its options, and once they are parsed, leaves what is to be done.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pliant_cli {

/// What the command line asks for; returns an exit code, throws what failure.h knows.
using Action = std::function<int()>;

void add_run(CLI::App& app, Action& action, const std::vector<std::string>& command_line);
void add_check(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_list(CLI::App& app, Action& action);
void add_render(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
void add_schema(CLI::App& app, Action& action);

}  // namespace pliant_cli
