#include <pliant/io/run/build_info.h>

#include <gnu/libc-version.h>

#include <Eigen/Core>

namespace pliant {

BuildInfo build_info() {
#if defined(__clang__)
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "gcc " __VERSION__;
#endif
#if defined(__x86_64__)
  // With FMA, sin, cos, pow and log of the C library use other instructions, which change the last bits.
  const std::string processor = __builtin_cpu_supports("fma") ? "x86-64 with FMA" : "x86-64";
#elif defined(__aarch64__)
  const std::string processor = "arm64";
#else
  const std::string processor = "other";
#endif
  return {{"pliant", PLIANT_VERSION},
          {"compiler", compiler},
          {"build_type", PLIANT_BUILD_TYPE},
          {"processor", processor},
          {"native", PLIANT_NATIVE_BUILD ? "yes" : "no"},
          {"vector_instructions", Eigen::SimdInstructionSetsInUse()},
          {"libc", gnu_get_libc_version()},
          {"eigen", PLIANT_EIGEN_VERSION}};
}

}  // namespace pliant
