// A pool of threads for loops over parts or islands, or over ranges of the elements of one part. Results do
// not depend on the number of threads: tasks that run at the same time never add to a shared sum.
#pragma once

#include <functional>
#include <memory>

namespace pliant {

/// A fixed number of threads that run the tasks of one loop at a time.
class ThreadPool {
 public:
  /// threads: number of threads, at least 1, including the thread that calls run(). With 1 all tasks run in
  /// the calling thread.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Returns the number of threads, including the thread that calls run().
  int threads() const;
  /// Calls task(i) for 0 <= i < n, in any order, and returns when all calls have ended. If tasks throw, run()
  /// rethrows the exception of the task with the lowest i. A call of run() from within a task runs all its
  /// tasks in the calling thread. If all tasks run in the calling thread, they run in order, and the tasks
  /// after one that throws do not run.
  void run(int n, const std::function<void(int)>& task);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pliant
