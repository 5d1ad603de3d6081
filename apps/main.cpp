// The program pliant: parses the command line and runs the selected command.
#include <cerrno>
#include <iostream>
#include <string>
#include <system_error>
#include <vector>

#include "command.h"
#include "exit_codes.h"
#include "failure.h"
#include "machine.h"

namespace {

int run_command(int argc, char** argv) {
  CLI::App app{
      "pliant simulates deformable solid primitives: scenes in JSON, motion as tables, meshes and pictures."};
  app.name("pliant");
#if CLI11_VERSION_MAJOR > 2 || (CLI11_VERSION_MAJOR == 2 && CLI11_VERSION_MINOR >= 6)
  app.get_formatter()->enable_footer_formatting(false);  // examples and tables keep their line breaks
#endif
  app.require_subcommand(1);
  app.set_version_flag("--version", pliant_cli::version_text(),
                       "Print versions, linked libraries and licences");
  app.footer(
      std::string("Examples:\n"
                  "  pliant run scenes/pull.json --png -o out/pull    simulate, record, draw\n"
                  "  pliant info scenes/pull.json                     parts, masses, degrees of freedom\n"
                  "  pliant list shapes                               parameters, ranges, formulas\n"
                  "  pliant run --help                                options of a command\n\n") +
      pliant_cli::kExitCodesHelp);
  pliant_cli::Action action;
  pliant_cli::add_run(app, action, std::vector<std::string>(argv, argv + argc));
  pliant_cli::add_check(app, action);
  pliant_cli::add_info(app, action);
  pliant_cli::add_list(app, action);
  pliant_cli::add_view(app, action);
  pliant_cli::add_render(app, action);
  pliant_cli::add_export(app, action);
  pliant_cli::add_verify(app, action);
  pliant_cli::add_schema(app, action);
  pliant_cli::add_doctor(app, action);
  if (argc <= 1) {
    std::cerr << app.help();
    return pliant_cli::kCommandLine;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return pliant_cli::report_parse_error(app, error);
  }
  return action();
}

}  // namespace

int main(int argc, char** argv) {
  pliant_cli::end_if_memory_is_exhausted();
  return pliant_cli::reporting_failures([&] {
    const int code = run_command(argc, argv);
    if (!std::cout.flush())
      throw std::system_error(errno, std::generic_category(), "cannot write standard output");
    return code;
  });
}
