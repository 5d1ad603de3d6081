// The threads wait for a call of run(), fetch task numbers from one counter, and signal that no task is left.
#include <pliant/math/thread_pool.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include <pliant/math/flush_subnormals.h>

namespace pliant {

namespace {
/// Whether this thread runs a task of a pool now.
thread_local bool in_task = false;
}  // namespace

struct ThreadPool::Impl {
  std::vector<std::thread> threads;
  std::mutex mutex;
  std::condition_variable wake, done;
  const std::function<void(int)>* task = nullptr;
  int n = 0;
  /// Whether the thread that calls run() flushes subnormal numbers. All threads then flush subnormal numbers,
  /// so that the result of a task does not depend on its thread.
  bool flush = false;
  std::atomic<int> next{0};
  int busy = 0;
  long round = 0;
  bool stop = false;
  int failed = -1;
  std::exception_ptr failure;

  void work() {
    const FlushSubnormals flushed(flush);
    in_task = true;
    for (int i = next.fetch_add(1); i < n; i = next.fetch_add(1)) {
      try {
        (*task)(i);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (failed < 0 || i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
    }
    in_task = false;
  }
  /// Ends all threads.
  void end() {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      stop = true;
    }
    wake.notify_all();
    for (std::thread& thread : threads) thread.join();
  }
  void serve() {
    long seen = 0;
    std::unique_lock<std::mutex> lock(mutex);
    for (;;) {
      wake.wait(lock, [&] { return stop || round != seen; });
      if (stop) return;
      seen = round;
      lock.unlock();
      work();
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

// If the system refuses a thread, the pool works with fewer threads: results do not depend on their number.
ThreadPool::ThreadPool(int threads) : impl_(std::make_unique<Impl>()) {
  impl_->threads.reserve(static_cast<std::size_t>(std::max(0, threads - 1)));
  try {
    for (int i = 1; i < threads; ++i) impl_->threads.emplace_back([pool = impl_.get()] { pool->serve(); });
  } catch (const std::system_error&) {
    // The pool works with the threads that exist.
  } catch (...) {
    impl_->end();
    throw;
  }
}

ThreadPool::~ThreadPool() {
  impl_->end();
}

int ThreadPool::threads() const {
  return static_cast<int>(impl_->threads.size()) + 1;
}

void ThreadPool::run(int n, const std::function<void(int)>& task) {
  Impl& pool = *impl_;
  if (pool.threads.empty() || n <= 1 || in_task) {
    for (int i = 0; i < n; ++i) task(i);
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(pool.mutex);
    pool.task = &task;
    pool.n = n;
    pool.flush = FlushSubnormals::active();
    pool.next = 0;
    pool.busy = static_cast<int>(pool.threads.size());
    pool.failed = -1;
    pool.failure = nullptr;
    ++pool.round;
  }
  pool.wake.notify_all();
  pool.work();
  std::unique_lock<std::mutex> lock(pool.mutex);
  pool.done.wait(lock, [&] { return pool.busy == 0; });
  if (pool.failure) std::rethrow_exception(pool.failure);
}

}  // namespace pliant
