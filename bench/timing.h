// Timing for benchmarks: the minimum time of several repeats, and calibration kernels. The kernels are
// measured in the same run as a benchmark. The ratio of both times is comparable between machines.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <limits>
#include <vector>

namespace pliant::bench {

/// Clock of the processor time of this process, summed over its threads. Other processes disturb this time
/// less than the wall-clock time. Use this clock for long calls in one thread, which other processes
/// interrupt.
struct ProcessorClock {
  using duration = std::chrono::duration<double>;
  using time_point = std::chrono::time_point<ProcessorClock, duration>;
  static time_point now() { return time_point(duration(static_cast<double>(std::clock()) / CLOCKS_PER_SEC)); }
};

/// Returns the seconds per call of f: the minimum over `repeats` batches. A batch is a number of calls that
/// together need at least `batch` seconds. A short batch can run without interruption by other programs.
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

/// Returns the multiply-adds per second of one core, with operands in registers. The multiply-adds are fused
/// if the program is compiled for a processor with such instructions.
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

/// Returns the bandwidth in bytes per second of a = b + s c over arrays of `bytes` bytes in total. The
/// default, 192 MiB, is larger than the caches of most processors.
inline double triad_bandwidth(std::size_t bytes = std::size_t{3} << 26) {
  const std::size_t n = bytes / (3 * sizeof(double));
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  const double time = seconds_per_call([&] {
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 0.5 * c[i];
  });
  return 3.0 * static_cast<double>(n * sizeof(double)) / time;
}

}  // namespace pliant::bench
