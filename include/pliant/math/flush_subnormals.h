// Numbers below 2e-308 count as zero while this lives: processors take a hundred times as long for them, and
// what decays along a chain makes many.
#pragma once

#include <cstdint>

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace pliant {

class FlushSubnormals {
 public:
  /// Nothing where the processor has no such mode, or on is false.
  explicit FlushSubnormals(bool on = true) : before_(mode()) {
    if (on) set_mode(before_ | kFlush);
  }
  ~FlushSubnormals() { set_mode((mode() & ~kFlush) | (before_ & kFlush)); }
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

  /// Whether they are flushed now, in this thread.
  static bool active() { return (mode() & kFlush) != 0; }

 private:
#if defined(__SSE2__)
  static constexpr std::uint64_t kFlush = 0x8040;  // of results and of operands
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
