#include "json_tokens.h"

#include <algorithm>
#include <charconv>

namespace pliant::json {

std::size_t skip_space(std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(" \t\r\n", at), text.size());
}

std::size_t string_end(std::string_view text, std::size_t at) {
  for (std::size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
    } else if (text[i] == '"') {
      return i + 1;
    }
  }
  return text.size();
}

std::size_t word_end(std::string_view text, std::size_t at) {
  const auto ends = [](char c) {
    return c == ',' || c == ':' || c == ']' || c == '}' || c == '[' || c == '{' || c == '"' || c == '/' ||
           c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0';
  };
  return static_cast<std::size_t>(
      std::find_if(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), ends) - text.begin());
}

std::size_t scalar_end(std::string_view text, std::size_t at) {
  for (const std::string_view word : {"true", "false", "null"}) {
    if (text.substr(at, word.size()) == word) return at + word.size();
  }
  const auto look = [&] { return at < text.size() ? text[at] : '\0'; };
  const auto digits = [&] {
    while (look() >= '0' && look() <= '9') ++at;
  };
  if (look() == '-') ++at;
  if (look() == '0') {
    ++at;
  } else {
    digits();
  }
  if (look() == '.') {
    ++at;
    digits();
  }
  if (look() == 'e' || look() == 'E') {
    ++at;
    if (look() == '+' || look() == '-') ++at;
    digits();
  }
  return at;
}

int hex4(std::string_view text, std::size_t at) {
  if (at + 4 > text.size()) return -1;
  unsigned value = 0;
  const char* first = text.data() + at;
  return std::from_chars(first, first + 4, value, 16).ptr == first + 4 ? static_cast<int>(value) : -1;
}

std::size_t string_byte(std::string_view text, std::size_t at, std::size_t byte) {
  std::size_t i = at + 1;
  std::size_t decoded = 0;
  while (i < text.size() && text[i] != '"') {
    std::size_t raw = 1, bytes = 1;
    if (text[i] == '\\') {
      raw = 2;
      if (i + 1 < text.size() && text[i + 1] == 'u') {
        const int unit = hex4(text, i + 2);
        const bool pair = unit >= 0xD800 && unit <= 0xDBFF;
        raw = pair ? 12 : 6;
        bytes = pair ? 4 : unit < 0x80 ? 1 : unit < 0x800 ? 2 : 3;
      }
    }
    if (decoded + bytes > byte) break;
    decoded += bytes;
    i += raw;
  }
  return std::min(i, text.size());
}

}  // namespace pliant::json
