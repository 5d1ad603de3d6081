// pliant schema: prints the JSON Schema of scene files.
#include <iostream>

#include <pliant/scene/schema/scene_schema.h>

#include "command.h"
#include "exit_codes.h"

namespace pliant_cli {

void add_schema(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("schema", "Print the JSON Schema of scene files");
  command->footer(
      "Example:\n"
      "  pliant schema > pliant-scene.schema.json\n"
      "Editors complete and check a scene that begins with \"$schema\": \"pliant-scene.schema.json\".");
  command->callback([&action] {
    action = [] {
      std::cout << pliant::schema::schema_json(pliant::scene_record());
      return kDone;
    };
  });
}

}  // namespace pliant_cli
