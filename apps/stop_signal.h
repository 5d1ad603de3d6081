// Signals that stop the program. After the first signal the program finishes the current file or step and
// ends. A second signal ends the program at once.
#pragma once

namespace pliant_cli {

/// Starts to catch SIGINT, SIGTERM, SIGHUP and SIGXCPU. From now on, SIGPIPE and SIGXFSZ are ignored: the
/// function that writes then reports the failed write.
void catch_stop_signals();
/// Returns the number of the first caught signal, or 0 if no signal was caught.
int stop_signal();

}  // namespace pliant_cli
