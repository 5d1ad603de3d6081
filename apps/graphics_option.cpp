// Declaration of --gl.
#include "graphics_option.h"

namespace pliant_cli {

void add_graphics_option(CLI::App& command, pliant::GlBackend& backend) {
  const std::map<std::string, pliant::GlBackend> names{{"auto", pliant::GlBackend::automatic},
                                                       {"osmesa", pliant::GlBackend::osmesa},
                                                       {"egl", pliant::GlBackend::egl}};
  command
      .add_option("--gl", backend,
                  "Graphics library for pictures: auto (the first that opens), osmesa or egl")
      ->transform(CLI::CheckedTransformer(names))
      ->option_text("auto|osmesa|egl");
}

}  // namespace pliant_cli
