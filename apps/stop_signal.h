// Signals that ask the program to stop: the first lets it end in good order, the second ends it at once.
#pragma once

namespace pliant_cli {

/// Begins to catch SIGINT, SIGTERM, SIGHUP and SIGXCPU; SIGPIPE and SIGXFSZ
/// are ignored from now on: a write that fails is an error where it happens.
void catch_stop_signals();
/// The number of the signal that was caught, 0 for none.
int stop_signal();

}  // namespace pliant_cli
