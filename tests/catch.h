// Includes Catch2, version 3 if it is installed, otherwise version 2.
#pragma once

#include <string>

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
namespace pliant::test {
/// Returns a matcher for texts that contain `part`.
inline auto has_text(const std::string& part) {
  return Catch::Matchers::ContainsSubstring(part);
}
}  // namespace pliant::test
#else
#include <catch2/catch.hpp>
using Catch::Detail::Approx;
namespace pliant::test {
/// Returns a matcher for texts that contain `part`.
inline auto has_text(const std::string& part) {
  return Catch::Matchers::Contains(part);
}
}  // namespace pliant::test
#endif
