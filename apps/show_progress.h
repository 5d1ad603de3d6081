// Progress on standard error. A terminal shows a bar. Otherwise a line is written at the end of each stage,
// once a minute, and at each tenth of a stage that has taken more than 2 s.
#pragma once

#include <memory>

#include <pliant/io/run/progress.h>

namespace pliant_cli {

/// Returns a progress display. quiet: the display shows neither progress nor notes. advance() of the display
/// throws pliant::Interrupted after a stop signal, except in the stage "simulate", which ends after the
/// current step without this exception.
std::unique_ptr<pliant::Progress> make_progress(bool quiet);

}  // namespace pliant_cli
