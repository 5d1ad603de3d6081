// The signal handler.
#include "stop_signal.h"

#include <csignal>
#include <initializer_list>

namespace pliant_cli {
namespace {

volatile std::sig_atomic_t caught = 0;

extern "C" void on_stop_signal(int number) {
  if (caught != 0) {
    std::signal(number, SIG_DFL);
    std::raise(number);
    return;
  }
  caught = number;
}

}  // namespace

void catch_stop_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
    struct sigaction action {};
    action.sa_handler = on_stop_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, nullptr);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int stop_signal() {
  return caught;
}

}  // namespace pliant_cli
