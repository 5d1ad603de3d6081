// A pool of threads for loops over parts, or over ranges of the elements of one. Which thread runs what never
// changes a result: nothing that runs at once adds to the same sum.
#pragma once

#include <functional>
#include <memory>

namespace pliant {

class ThreadPool {
 public:
  /// threads >= 1; with 1 everything runs in the calling thread.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;
  /// task(i) for 0 <= i < n, in any order; returns when all are done. The first exception of the lowest i is
  /// rethrown. Within a task of a pool everything runs in the calling thread.
  void run(int n, const std::function<void(int)>& task);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pliant
