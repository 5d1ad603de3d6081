// Loops over elements or nodes in ranges of fixed length, shared among threads. The ranges do not depend on
// the number of threads, and each writes places of its own.
#pragma once

#include <algorithm>
#include <functional>

#include <pliant/math/thread_pool.h>

namespace pliant {

/// body(first, last) for [0, n) in ranges of `length`; in the calling thread when pool is nullptr or the work
/// is no more than a range. Takes nothing from the heap.
template <class Body>
void for_ranges(int n, int length, ThreadPool* pool, Body&& body) {
  if (pool == nullptr || n <= length) {
    body(0, n);
    return;
  }
  auto task = [&](int i) { body(i * length, std::min(n, (i + 1) * length)); };
  pool->run((n + length - 1) / length, std::ref(task));
}

}  // namespace pliant
