#include "options.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace pliant_cli {
namespace {

constexpr int kMostPixels = 8192;

template <class Number>
std::optional<Number> parse(const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || at != end) return std::nullopt;
  return number;
}

CLI::Validator number_that(const std::string& expected, const std::function<bool(double)>& good) {
  return {[expected, good](std::string& text) -> std::string {
            const std::optional<double> number = parse<double>(text);
            if (number && std::isfinite(*number) && good(*number)) return {};
            return "\"" + text + "\" is not " + expected;
          },
          ""};
}

}  // namespace

CLI::Validator positive_number() {
  return number_that("a number > 0", [](double x) { return x > 0; });
}

CLI::Validator number_from_zero() {
  return number_that("a number >= 0", [](double x) { return x >= 0; });
}

CLI::Validator any_number() {
  return number_that("a finite number", [](double) { return true; });
}

CLI::Validator count_up_to(int most) {
  return {[most](std::string& text) -> std::string {
            const std::optional<int> number = parse<int>(text);
            if (number && *number >= 1 && *number <= most) return {};
            return "\"" + text + "\" is not a whole number from 1 to " + std::to_string(most);
          },
          ""};
}

PictureSize parse_picture_size(const std::string& text) {
  const std::size_t by = text.find('x');
  if (by == std::string::npos) return {};
  const std::optional<int> width = parse<int>(text.substr(0, by)), height = parse<int>(text.substr(by + 1));
  const auto good = [](const std::optional<int>& n) { return n && *n >= 1 && *n <= kMostPixels; };
  if (!good(width) || !good(height)) return {};
  return {*width, *height};
}

CLI::Validator picture_size() {
  return {[](std::string& text) -> std::string {
            if (parse_picture_size(text).width > 0) return {};
            return "\"" + text + "\" is not a size like 640x480 (each side from 1 to " +
                   std::to_string(kMostPixels) + ")";
          },
          ""};
}

}  // namespace pliant_cli
