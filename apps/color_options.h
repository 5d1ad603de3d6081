// The options --color-by and --color-range: colours of parts by a quantity of their deformation.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <pliant/scene/scene.h>

namespace pliant_cli {

struct ColorOptions {
  std::string by;             ///< "part", or the name of a quantity; empty for the setting of the scene
  std::vector<double> range;  ///< values of the first and the last colour; empty if not set
};
/// Declares --color-by and --color-range.
void add_color_options(CLI::App& command, ColorOptions& options);
/// Declares --color-by only, for commands whose files contain the values and not their colours.
void add_color_by(CLI::App& command, ColorOptions& options);
/// Throws CLI::ValidationError unless the range is empty, or increasing with a finite difference.
void check_colors(const ColorOptions& options);
/// Sets the colouring of a scene by the options. Without --color-by, the scene does not change. "part"
/// removes the colouring. A quantity that differs from the quantity of the scene removes the range of the
/// scene, and keeps the list of coloured parts. --color-range then sets the range.
void apply_colors(const ColorOptions& options, pliant::Scene& scene);

}  // namespace pliant_cli
