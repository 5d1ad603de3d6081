// Parallel loops over elements or nodes, in ranges of fixed length. If each range writes only the memory of
// its own elements or nodes, results do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <functional>

#include <pliant/math/thread_pool.h>

namespace pliant {

/// Calls body(first, last) for ranges of at most `length` that cover [0, n). If pool is nullptr or n <=
/// length, calls body(0, n) once in the calling thread. Allocates no heap memory.
template <class Body>
void for_ranges(int n, int length, ThreadPool* pool, Body&& body) {
  if (pool == nullptr || n <= length) {
    body(0, n);
    return;
  }
  auto task = [&](int i) { body(i * length, std::min(n, (i + 1) * length)); };
  pool->run((n + length - 1) / length, std::ref(task));
}

/// Calls f(first, last) for every block of `length` indices in [0, n); the last block may be shorter. If pool
/// is nullptr, f is called in the calling thread, also once for each block. f may therefore compute the
/// number of the block from `first`.
template <class F>
void for_blocks(int n, int length, ThreadPool* pool, F&& f) {
  auto task = [&](int block) { f(block * length, std::min(n, (block + 1) * length)); };
  const int blocks = (n + length - 1) / length;
  if (pool != nullptr)
    pool->run(blocks, std::ref(task));
  else
    for (int i = 0; i < blocks; ++i) task(i);
}

}  // namespace pliant
