// Progress on standard error: a bar on a terminal, elsewhere a line at each tenth of a stage that is longer
// than 2 s, at least once a minute, and at its end; nothing if quiet.
#pragma once

#include <memory>

#include <pliant/io/run/progress.h>

namespace pliant_cli {

/// Returns a progress display. quiet: shows nothing, notes included. Its advance() throws pliant::Interrupted
/// after a stop signal, except in the stage "simulate": the simulation itself ends after the current step.
std::unique_ptr<pliant::Progress> make_progress(bool quiet);

}  // namespace pliant_cli
