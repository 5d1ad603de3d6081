// System calls that a signal may interrupt.
#pragma once

#include <cerrno>

namespace pliant {

/// Repeats a system call until no signal interrupts it (EINTR), and returns its result. Not for close(): on
/// Linux an interrupted close() has closed the descriptor.
template <class Call>
auto retry(Call&& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace pliant
