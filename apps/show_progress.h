// Progress on standard error: a bar on a terminal, occasional lines elsewhere, nothing if quiet.
#pragma once

#include <memory>

#include <pliant/io/run/progress.h>

namespace pliant_cli {

/// Returns a progress display. Its advance() throws pliant::Interrupted after a stop signal, except during
/// the simulation, which stops by itself after a step.
std::unique_ptr<pliant::Progress> make_progress(bool quiet);

}  // namespace pliant_cli
