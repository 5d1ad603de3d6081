// Timing for benches: the least time of several repeats, and calibration kernels measured beside them, so
// that results are ratios that hold on any machine.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <limits>
#include <vector>

namespace pliant::bench {

/// Processor time of this process, which others on the machine stretch less: for calls in one thread that are
/// too long to escape them.
struct ProcessorClock {
  using duration = std::chrono::duration<double>;
  using time_point = std::chrono::time_point<ProcessorClock, duration>;
  static time_point now() { return time_point(duration(static_cast<double>(std::clock()) / CLOCKS_PER_SEC)); }
};

/// Seconds that one call of f takes: the least of `repeats` batches, each as long as `batch` seconds; short
/// ones run between what else the machine does.
template <class Clock = std::chrono::steady_clock, class F>
double seconds_per_call(F&& f, double batch = 0.002, int repeats = 90) {
  auto elapsed = [&](long calls) {
    const auto start = Clock::now();
    for (long i = 0; i < calls; ++i) f();
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  long calls = 1;
  double time = elapsed(calls);
  while (time < batch) {
    calls = std::max(2 * calls,
                     static_cast<long>(1.2 * static_cast<double>(calls) * batch / std::max(time, 1e-9)));
    time = elapsed(calls);
  }
  for (int i = 1; i < repeats; ++i) time = std::min(time, elapsed(calls));
  return time / static_cast<double>(calls);
}

/// Multiply-adds per second of one core, in registers; fused where the target has them.
inline double multiply_add_peak() {
#ifdef __AVX__
  constexpr int lanes = 12 * 4;
#else
  constexpr int lanes = 12 * 2;
#endif
  double x[lanes];
  for (int i = 0; i < lanes; ++i) x[i] = 1.0 + i;
  volatile double sink = 0;
  const double time = seconds_per_call([&] {
    for (int round = 0; round < 1000; ++round)
      for (int i = 0; i < lanes; ++i) {
#ifdef __FMA__
        x[i] = std::fma(x[i], 0.999999, 1e-6);
#else
        x[i] = x[i] * 0.999999 + 1e-6;
#endif
      }
    for (const double lane : x) sink = sink + lane;
  });
  return 1000.0 * lanes / time;
}

/// Bytes per second of a = b + s c over arrays of so many bytes in all; by default they fit no cache.
inline double triad_bandwidth(std::size_t bytes = std::size_t{3} << 26) {
  const std::size_t n = bytes / (3 * sizeof(double));
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  const double time = seconds_per_call([&] {
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 0.5 * c[i];
  });
  return 3.0 * static_cast<double>(n * sizeof(double)) / time;
}

}  // namespace pliant::bench
