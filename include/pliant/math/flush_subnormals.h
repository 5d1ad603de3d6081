// A guard that flushes subnormal numbers (below 2.2e-308) to zero while the guard exists. Arithmetic with
// subnormal numbers is about a hundred times slower, and motions that decay along a chain of parts produce
// many of them.
#pragma once

#include <cstdint>

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace pliant {

/// Sets the flush-to-zero mode of the calling thread; the destructor restores the previous mode.
class FlushSubnormals {
 public:
  /// Changes nothing if `on` is false or if the processor has no such mode.
  explicit FlushSubnormals(bool on = true) : before_(mode()) {
    if (on) set_mode(before_ | kFlush);
  }
  ~FlushSubnormals() { set_mode((mode() & ~kFlush) | (before_ & kFlush)); }
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

  /// Returns whether the calling thread flushes subnormal numbers now.
  static bool active() { return (mode() & kFlush) != 0; }

 private:
#if defined(__SSE2__)
  static constexpr std::uint64_t kFlush = 0x8040;  // the bits for results and for operands
  static std::uint64_t mode() {
    return _mm_getcsr();
  }
  static void set_mode(std::uint64_t mode) {
    _mm_setcsr(static_cast<unsigned>(mode));
  }
#elif defined(__aarch64__)
  static constexpr std::uint64_t kFlush = std::uint64_t{1} << 24;
  static std::uint64_t mode() {
    std::uint64_t mode = 0;
    asm volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
  }
  static void set_mode(std::uint64_t mode) {
    asm volatile("msr fpcr, %0" : : "r"(mode));
  }
#else
  static constexpr std::uint64_t kFlush = 0;
  static std::uint64_t mode() {
    return 0;
  }
  static void set_mode(std::uint64_t) {}
#endif

  std::uint64_t before_;
};

}  // namespace pliant
