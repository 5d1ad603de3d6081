// Declaration, check and use of --color-by and --color-range.
#include "color_options.h"

#include <cmath>

#include "options.h"

namespace pliant_cli {
namespace {

constexpr const char* kOwnColors = "part";

CLI::Option* add_by(CLI::App& command, ColorOptions& options, const std::string& meaning) {
  std::vector<std::string> names{kOwnColors};
  std::string words = kOwnColors;
  for (const pliant::QuantityInfo& info : pliant::all_quantities()) {
    names.emplace_back(info.name);
    words += std::string("|") + info.name;
  }
  return command.add_option("--color-by", options.by, meaning)
      ->check(CLI::IsMember(names))
      ->option_text(words);
}

}  // namespace

void add_color_by(CLI::App& command, ColorOptions& options) {
  add_by(command, options,
         "Quantity written with each vertex of a PLY file; \"part\" for no quantity [as in the scene]");
}

void add_color_options(CLI::App& command, ColorOptions& options) {
  CLI::Option* by = add_by(command, options,
                           "Colours in pictures: \"part\" for the own colour of each part, or a quantity of "
                           "the deformation [as in the scene]");
  command
      .add_option(
          "--color-range", options.range,
          "Values of the first and the last colour [as in the scene, or 0 to the 99th percentile of the "
          "recorded values, rounded up]")
      ->expected(2)
      ->check(any_number())
      ->needs(by)
      ->option_text("FROM TO");
}

void check_colors(const ColorOptions& options) {
  if (options.range.empty()) return;
  const double span = options.range[1] - options.range[0];
  if (!(span > 0) || !std::isfinite(span))
    throw CLI::ValidationError("--color-range",
                               "the second number must be larger than the first, and both must be finite");
}

void apply_colors(const ColorOptions& options, pliant::Scene& scene) {
  if (options.by.empty()) return;
  const std::optional<pliant::SurfaceQuantity> by = pliant::find_quantity(options.by);
  if (!by) {
    scene.coloring.reset();
    return;
  }
  // The range of the scene is valid only for the quantity of the scene.
  if (!scene.coloring || scene.coloring->by != *by) {
    pliant::Coloring asked;
    asked.by = *by;
    if (scene.coloring) asked.parts = scene.coloring->parts;
    scene.coloring = asked;
  }
  if (!options.range.empty()) scene.coloring->range = {options.range[0], options.range[1]};
}

}  // namespace pliant_cli
