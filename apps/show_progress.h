// Progress on standard error. A terminal shows a bar. Otherwise a line is written at the end of each stage
// and once a minute, and also at each tenth of a stage after its first 2 s. If quiet, nothing is written.
#pragma once

#include <memory>

#include <pliant/io/run/progress.h>

namespace pliant_cli {

/// Returns a progress display. quiet: the display shows nothing, and no notes. advance() of the display
/// throws pliant::Interrupted after a stop signal, except in the stage "simulate". This stage ends by itself
/// after the current step.
std::unique_ptr<pliant::Progress> make_progress(bool quiet);

}  // namespace pliant_cli
