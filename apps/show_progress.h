// Progress on standard error: a bar on a terminal, now and then a line elsewhere, nothing when quiet.
#pragma once

#include <memory>

#include <pliant/io/run/progress.h>

namespace pliant_cli {

/// Its advance() throws pliant::Interrupted when a stop signal came during a stage that cannot stop in the
/// middle itself.
std::unique_ptr<pliant::Progress> make_progress(bool quiet);

}  // namespace pliant_cli
