// Numbers as text, independent of the locale. append_number() and number_text() give the shortest decimal
// text that reads back exactly.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>

namespace pliant {

inline void append_number(std::string& text, double x) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, x).ptr);
}
inline void append_number(std::string& text, std::int64_t n) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, n).ptr);
}
inline std::string number_text(double x) {
  std::string text;
  append_number(text, x);
  return text;
}
/// Returns a number rounded to a few significant digits, for messages.
inline std::string rounded_text(double x, int significant = 4) {
  char digits[32];
  return {digits,
          std::to_chars(digits, digits + sizeof digits, x, std::chars_format::general, significant).ptr};
}
/// Returns a number with its noun: "1 frame", "2 frames".
inline std::string count_text(std::int64_t n, const std::string& noun) {
  std::string text;
  append_number(text, n);
  return text + " " + noun + (n == 1 ? "" : "s");
}

}  // namespace pliant
