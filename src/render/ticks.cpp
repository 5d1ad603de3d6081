// Round numbers along a scale, and their labels.
#include <pliant/render/ticks.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace pliant {
namespace {

constexpr int kMaxDecimals = 4, kMaxDigits = 6, kMaxTicks = 12;

// Returns the label of a value, with as many digits as the step needs. The notation is scientific if the
// labels of the scale need more than kMaxDecimals decimals, or more than kMaxDigits digits before the decimal
// point.
std::string label(double value, double step, double largest) {
  const int last = static_cast<int>(std::floor(std::log10(step) + 1e-9));
  const int first = static_cast<int>(std::floor(std::log10(largest) + 1e-9));
  std::array<char, 64> text{};
  if (value == 0) return "0";
  const bool plain = -last <= kMaxDecimals && first < kMaxDigits;
  const int own = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
  const auto end = plain
                       ? std::to_chars(text.data(), text.data() + text.size(), value,
                                       std::chars_format::fixed, std::max(0, -last))
                       : std::to_chars(text.data(), text.data() + text.size(), value,
                                       std::chars_format::scientific, std::clamp(own - last, 0, kMaxDigits));
  return {text.data(), end.ptr};
}

}  // namespace

double tick_step(double span) {
  const double wanted = span / 5, decade = std::pow(10.0, std::floor(std::log10(wanted)));
  const double m = wanted / decade;
  return decade * (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10);
}

std::vector<Tick> ticks(double low, double high) {
  const double step = tick_step(high - low), slack = 1e-9 * (high - low);
  const double largest = std::max(std::abs(low), std::abs(high));
  const double first = std::ceil((low - slack) / step);
  std::vector<Tick> all;
  for (int i = 0; i < kMaxTicks && (first + i) * step <= high + slack; ++i)
    all.push_back({(first + i) * step, label((first + i) * step, step, largest)});
  return all;
}

}  // namespace pliant
