#include "json_fault.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

#include "json_tokens.h"
#include "utf8.h"

namespace pliant::json {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '$';
}

std::string lower(std::string_view word) {
  std::string result(word);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string hex_byte(char c) {
  char text[8];
  std::snprintf(text, sizeof text, "0x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
  return text;
}

/// Finds the fault at which the parser stopped and describes it.
class Explainer {
 public:
  explicit Explainer(const Progress& progress) : p_(progress), text_(progress.text) {}

  Fault explain() {
    const std::size_t at = skip_space(text_, p_.at);
    switch (p_.after) {
      case After::kNothing:
      case After::kArrayStart:
        return value(at, "a value");
      case After::kObjectStart:
        return key(at, "a key in double quotes or \"}\"");
      case After::kKey:
        return after_key(at);
      case After::kMember:
        return after_item(at, '}');
      case After::kElement:
        return after_item(at, ']');
      case After::kDocument:
        break;
    }
    if (begins_comment(at)) return comment(at);
    return fault(at, found(at) + " after the end of the document; a file contains one value");
  }

 private:
  static Fault fault(std::size_t offset, std::string message) { return {offset, "", std::move(message)}; }
  bool ended(std::size_t at) const { return at >= text_.size(); }
  char look(std::size_t at) const { return ended(at) ? '\0' : text_[at]; }
  bool begins_comment(std::size_t at) const {
    return look(at) == '#' || (look(at) == '/' && (look(at + 1) == '/' || look(at + 1) == '*'));
  }

  static Fault comment(std::size_t at) {
    return fault(at, "JSON has no comments; write one as a key: \"//\": \"text\" (it may repeat)");
  }

  /// Returns the token at an offset in quotes, cut after 30 bytes, or the words "the end of the file".
  std::string found(std::size_t at) const {
    if (ended(at)) return "the end of the file";
    std::size_t end = look(at) == '"' ? string_end(text_, at) : word_end(text_, at);
    if (end == at) end = at + 1;
    const bool cut = end - at > 30;
    if (cut) end = at + 30;
    while (end < text_.size() && (static_cast<unsigned char>(text_[end]) & 0xC0) == 0x80) ++end;
    if (look(at) == '"' && !cut) return std::string(text_.substr(at, end - at));
    return "\"" + std::string(text_.substr(at, end - at)) + (cut ? "...\"" : "\"");
  }

  Fault unclosed(std::size_t at) const {
    if (!p_.open) return fault(at, "the file ends where a value is expected");
    const std::string opening(1, text_[p_.opening]);
    return fault(at, "the file ends, but \"" + opening + "\" at " + p_.place(p_.opening) +
                         " is still open; expected \"" + (opening == "{" ? "}" : "]") + "\"");
  }

  Fault after_key(std::size_t at) {
    if (ended(at)) return unclosed(at);
    if (look(at) == ':') return value(skip_space(text_, at + 1), "a value after \":\"");
    if (begins_comment(at)) return comment(at);
    return fault(at, found(at) + "; expected \":\" after a key");
  }

  Fault after_item(std::size_t at, char closing) {
    const bool object = closing == '}';
    if (ended(at)) return unclosed(at);
    if (begins_comment(at)) return comment(at);
    if (look(at) == ',') {
      const std::size_t next = skip_space(text_, at + 1);
      if (look(next) == closing) {
        return fault(at, std::string("a comma before \"") + closing + "\"; remove it");
      }
      if (object && at > 0 && is_digit(text_[at - 1]) && is_digit(look(at + 1)))
        return fault(at, "a decimal point is written \".\", not \",\"");
      return object ? key(next, "a key in double quotes") : value(next, "a value");
    }
    if (look(at) == '}' || look(at) == ']') {
      return fault(at, std::string("\"") + look(at) + "\" does not close \"" + text_[p_.opening] + "\" at " +
                           p_.place(p_.opening) + "; expected \"" + closing + "\" before it");
    }
    if (look(at) == '"' || look(at) == '{' || look(at) == '[' || look(at) == '-' || is_digit(look(at)) ||
        is_letter(look(at))) {
      return fault(at, found(at) + "; expected \",\" before it or \"" + closing + "\"");
    }
    return fault(at, found(at) + "; expected \",\" or \"" + closing + "\"");
  }

  Fault key(std::size_t at, const std::string& expected) {
    if (ended(at)) return unclosed(at);
    if (look(at) == '"') return string(at);
    if (begins_comment(at)) return comment(at);
    if (look(at) == '\'' || is_letter(look(at))) {
      return fault(at, found(at) + "; a key is written in double quotes");
    }
    return fault(at, found(at) + "; expected " + expected);
  }

  Fault value(std::size_t at, const std::string& expected) {
    if (ended(at)) return unclosed(at);
    const char c = look(at);
    if (c == '"') return string(at);
    if (begins_comment(at)) return comment(at);
    if (c == '\'') return fault(at, found(at) + "; text is written in double quotes");
    if (is_digit(c) || c == '-' || c == '+' || c == '.') return number(at);
    if (is_letter(c)) return word(at);
    return fault(at, found(at) + "; expected " + expected);
  }

  Fault word(std::size_t at) const {
    const std::string small = lower(text_.substr(at, word_end(text_, at) - at));
    if (small == "nan" || small == "inf" || small == "infinity") return not_finite(at);
    if (small == "true" || small == "false" || small == "null") {
      return fault(at, found(at) + "; expected a value; did you mean \"" + small + "\"?");
    }
    if (small == "none") return fault(at, found(at) + "; expected a value; did you mean \"null\"?");
    return fault(at, found(at) + "; expected a value; text is written in double quotes");
  }

  Fault not_finite(std::size_t at) const {
    return fault(at, found(at) + "; not JSON; write a finite number");
  }

  Fault number(std::size_t at) const {
    const std::string_view token = text_.substr(at, word_end(text_, at) - at);
    const std::string small = lower(token);
    const std::string_view size =
        small.empty() ? "" : std::string_view(small).substr(look(at) == '-' || look(at) == '+');
    if (size.rfind("inf", 0) == 0 || size.rfind("nan", 0) == 0 || small.find('#') != std::string::npos) {
      return not_finite(at);
    }
    double x = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), x);
    const bool whole = end == token.data() + token.size();
    if (whole && (error == std::errc::result_out_of_range || std::isinf(x))) {
      return fault(at, found(at) + "; too large for a number; expected at most 1.797e308 in magnitude");
    }
    if (look(at) == '+') return fault(at, found(at) + "; a number has no leading \"+\"");
    if (size.size() > 1 && size[0] == '0' && (is_digit(size[1]) || size[1] == 'x')) {
      return fault(at, found(at) + "; a number has no leading zero");
    }
    if (whole) return fault(at, found(at) + "; a number has digits before and after its point");
    const bool unit = !token.empty() && is_digit(token[0]) && is_letter(token.back()) && small.back() != 'e';
    return fault(at, found(at) + (unit ? "; expected a number without a unit; the unit of each key is fixed"
                                       : "; expected a number"));
  }

  Fault string(std::size_t quote) const {
    for (std::size_t i = quote + 1; i < text_.size();) {
      const char c = text_[i];
      if (c == '"') return fault(quote, "unexpected " + found(quote) + " here");
      if (c == '\n' || c == '\r') {
        return fault(
            quote,
            "the text that begins here is not closed on its line; expected '\"' (a line break is \\n)");
      }
      if (c == '\0') return fault(i, "a NUL byte in a text");
      if (static_cast<unsigned char>(c) < 0x20) {
        return fault(i, "control byte " + hex_byte(c) + " in a text; write it as " +
                            (c == '\t' ? "\\t" : "an escape \\u00" + hex_byte(c).substr(2)));
      }
      if (c == '\\') {
        const std::size_t length = escape_length(i);
        if (length == 0) return bad_escape(i);
        i += length;
        continue;
      }
      const std::size_t length = utf8::length(text_, i);
      if (length == 0) {
        return fault(i, "byte " + hex_byte(c) + " (offset " + std::to_string(i) +
                            ") is not UTF-8; save the file in UTF-8");
      }
      i += length;
    }
    return fault(quote, "the text that begins here is not closed; expected '\"'");
  }

  /// Returns the length in bytes of the escape sequence at `at`, or 0 if the sequence is not valid.
  std::size_t escape_length(std::size_t at) const {
    const char c = look(at + 1);
    if (c != 'u')
      return std::string_view("\"\\/bfnrt").find(c) != std::string_view::npos && c != '\0' ? 2 : 0;
    const int unit = hex4(text_, at + 2);
    if (unit < 0 || (unit >= 0xDC00 && unit <= 0xDFFF)) return 0;
    if (unit < 0xD800 || unit > 0xDBFF) return 6;
    const bool pair = look(at + 6) == '\\' && look(at + 7) == 'u';
    const int second = pair ? hex4(text_, at + 8) : -1;
    return second >= 0xDC00 && second <= 0xDFFF ? 12 : 0;
  }

  Fault bad_escape(std::size_t at) const {
    if (look(at + 1) == 'u') {
      const int unit = hex4(text_, at + 2);
      if (unit < 0) return fault(at, "\\u; expected four hexadecimal digits");
      return fault(
          at, std::string(text_.substr(at, 6)) + " is half of a surrogate pair; write the character itself");
    }
    return fault(at, std::string("\\") + std::string(text_.substr(at + 1, 1)) +
                         " is not an escape; expected one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\uXXXX; a "
                         "backslash is \\\\");
  }

  const Progress& p_;
  std::string_view text_;
};

}  // namespace

Fault explain(const Progress& progress) {
  return Explainer(progress).explain();
}

bool is_foreign(std::string_view text, Fault* fault) {
  using namespace std::string_view_literals;
  static constexpr std::pair<std::string_view, std::string_view> kBeginnings[] = {
      {"\x1F\x8B"sv, "looks like gzip; expected JSON; unpack it first"},
      {"PK\x03\x04"sv, "looks like a zip archive; expected JSON; unpack it first"},
      {"\x28\xB5\x2F\xFD"sv, "looks like zstd; expected JSON; unpack it first"},
      {"\xFD"
       "7zXZ"sv,
       "looks like xz; expected JSON; unpack it first"},
      {"BZh"sv, "looks like bzip2; expected JSON; unpack it first"},
      {"\x89PNG"sv, "looks like a PNG picture; expected JSON"},
      {"\xFF\xD8\xFF"sv, "looks like a JPEG picture; expected JSON"},
      {"\x93NUMPY"sv, "looks like a NumPy array; expected JSON"},
      {"%PDF"sv, "looks like a PDF; expected JSON"},
      {"\x7F"
       "ELF"sv,
       "looks like a program; expected JSON"},
      {"\xFF\xFE"sv, "looks like UTF-16; save the file in UTF-8"},
      {"\xFE\xFF"sv, "looks like UTF-16; save the file in UTF-8"},
      {"{\0"sv, "looks like UTF-16; save the file in UTF-8"},
      {"\0{"sv, "looks like UTF-16; save the file in UTF-8"},
      {"<"sv, "looks like XML; expected JSON"},
  };
  for (const auto& [beginning, message] : kBeginnings) {
    if (text.substr(0, beginning.size()) == beginning) {
      *fault = {0, "", std::string(message)};
      return true;
    }
  }
  const std::size_t mark = text.substr(0, 3) == kByteOrderMark ? 3 : 0;
  if (skip_space(text, mark) < text.size()) return false;
  *fault = {0, "", "empty; expected a JSON object"};
  return true;
}

}  // namespace pliant::json
