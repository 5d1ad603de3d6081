#include "json_write.h"

#include <charconv>
#include <cstdio>

#include "utf8.h"

namespace pliant {

std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = utf8::length(text, i);
    const char c = text[i];
    if (n == 0) {
      out += "\xEF\xBF\xBD";
    } else if (n > 1) {
      out += text.substr(i, n);
    } else if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
      out += code;
    } else {
      out += c;
    }
    i += n == 0 ? 1 : n;
  }
  return out + '"';
}

std::string shortest(double x) {
  char text[32];
  std::string written(text, std::to_chars(text, text + sizeof text, x).ptr);
  const std::size_t exponent = written.find('e');  // 1e+12 becomes 1e12, 1e-05 becomes 1e-5
  if (exponent == std::string::npos) return written;
  if (written[exponent + 1] == '+') written.erase(exponent + 1, 1);
  const std::size_t digits = exponent + (written[exponent + 1] == '-' ? 2 : 1);
  while (written[digits] == '0') written.erase(digits, 1);
  return written;
}

}  // namespace pliant
