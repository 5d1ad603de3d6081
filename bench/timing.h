// Timing for benches: the least time of several repeats, and calibration kernels measured beside them, so
// that results are ratios that hold on any machine.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

namespace pliant::bench {

/// Seconds that one call of f takes: the least of `repeats` batches, each as long as `batch` seconds.
template <class F>
double seconds_per_call(F&& f, double batch = 0.002, int repeats = 90) {
  using clock = std::chrono::steady_clock;
  auto elapsed = [&](long calls) {
    const auto start = clock::now();
    for (long i = 0; i < calls; ++i) f();
    return std::chrono::duration<double>(clock::now() - start).count();
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

/// Multiply-adds per second of one core, in registers.
inline double multiply_add_peak() {
  constexpr int lanes = 32;
  alignas(64) double x[lanes];
  for (int i = 0; i < lanes; ++i) x[i] = 1.0 + i;
  volatile double sink = 0;
  const double time = seconds_per_call([&] {
    for (int round = 0; round < 1000; ++round)
      for (int i = 0; i < lanes; ++i) x[i] = x[i] * 0.999999 + 1e-6;
    sink = sink + x[0];
  });
  return 1000.0 * lanes / time;
}

/// Bytes per second of a = b + s c over arrays that fit no cache.
inline double triad_bandwidth() {
  const std::size_t n = std::size_t{1} << 23;
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  const double time = seconds_per_call(
      [&] {
        for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 0.5 * c[i];
      },
      0.02, 5);
  return 3.0 * static_cast<double>(n * sizeof(double)) / time;
}

}  // namespace pliant::bench
