// Colouring parts by how they are deformed: --color-by and --color-range.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <pliant/scene/scene.h>

namespace pliant_cli {

struct ColorOptions {
  std::string by;  ///< "part", the name of a quantity, or empty: as the scene says
  std::vector<double> range;
};
/// Declares --color-by and --color-range.
void add_color_options(CLI::App& command, ColorOptions& options);
/// Declares --color-by alone, for files that hold values and no colours of them.
void add_color_by(CLI::App& command, ColorOptions& options);
/// Throws CLI::ValidationError on a range that does not rise.
void check_colors(const ColorOptions& options);
void apply_colors(const ColorOptions& options, pliant::Scene& scene);

}  // namespace pliant_cli
