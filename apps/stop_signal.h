// Signals that stop the program. After the first one it completes its files and ends; a second one ends it at
// once.
#pragma once

namespace pliant_cli {

/// Starts to catch SIGINT, SIGTERM, SIGHUP and SIGXCPU. Ignores SIGPIPE and SIGXFSZ from now on: a failed
/// write is reported by the function that writes.
void catch_stop_signals();
/// Returns the number of the caught signal; 0 for none.
int stop_signal();

}  // namespace pliant_cli
