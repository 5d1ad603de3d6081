#include "words.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include <pliant/scene/diagnostics.h>

namespace pliant {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Removes a plus sign at the beginning of a word, which std::from_chars does not accept. The sign stays if
/// the word has no other character, or if another sign follows.
std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

/// Returns whether a decimal number outside the range of double is too large; if not, the number is too close
/// to zero. The number may have any number of digits.
bool is_too_large(std::string_view digits) {
  const std::size_t e = std::min(digits.size(), digits.find_first_of("eE"));
  long long exponent = 0;
  const std::string_view power = without_plus(digits.substr(std::min(digits.size(), e + 1)));
  if (std::from_chars(power.data(), power.data() + power.size(), exponent).ec ==
      std::errc::result_out_of_range)
    return power[0] != '-';
  const std::string_view mantissa = digits.substr(0, e);
  const std::size_t point = std::min(mantissa.size(), mantissa.find('.')),
                    leading = std::min(mantissa.size(), mantissa.find_first_of("123456789"));
  // The first nonzero digit is `places` digits before the decimal point, or -`places` digits after the point.
  const long long places = static_cast<long long>(point) - static_cast<long long>(leading);
  return exponent > -places;
}

}  // namespace

std::string_view Words::word_from(std::size_t begin) {
  std::size_t end = begin;
  while (end < text_.size() && !is_blank(text_[end]) && text_[end] != '\n') ++end;
  word_at_ = begin;
  word_size_ = end - begin;
  at_ = end;
  return text_.substr(begin, end - begin);
}

std::string_view Words::on_line() {
  for (;;) {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    if (at_ >= text_.size() || text_[at_] == '\n' || text_[at_] == '#') {
      word_at_ = at_;
      word_size_ = 0;
      return {};
    }
    const std::string_view word = word_from(at_);
    const bool ends_line = at_ >= text_.size() || text_[at_] == '\n' || text_[at_] == '\r';
    if (!ends_line || word.back() != '\\') return word;
    if (word.size() > 1) {  // the next call continues with the backslash
      --at_;
      --word_size_;
      return word.substr(0, word.size() - 1);
    }
    at_ = std::min(text_.size(), text_.find('\n', at_));
    if (at_ < text_.size()) ++at_;
  }
}

bool Words::next_line() {
  at_ = std::min(text_.size(), text_.find('\n', at_));
  if (at_ >= text_.size()) return false;
  ++at_;
  return at_ < text_.size();
}

std::string_view Words::next() {
  while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '\n')) ++at_;
  return word_from(at_);
}

double Words::number(std::string_view word, const char* meaning) const {
  const std::string_view digits = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || end != digits.data() + digits.size() || error == std::errc::invalid_argument)
    fail(std::string(meaning) + ", a decimal number such as 1.5 or 2e-3");
  if (error == std::errc::result_out_of_range) {
    if (is_too_large(digits)) fail(std::string(meaning) + ", a number of absolute value below 1.8e308");
    return 0;
  }
  if (!std::isfinite(value)) fail(std::string(meaning) + ", a finite number");
  return value;
}

long long Words::integer(std::string_view word, long long min, long long max, const char* meaning) const {
  const std::string_view digits = without_plus(word);
  long long value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value < min || value > max)
    fail(std::string(meaning) + ", an integer from " + std::to_string(min) + " to " + std::to_string(max));
  return value;
}

void Words::fail(const std::string& expected) const {
  const std::string_view before = text_.substr(0, word_at_);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t start = before.rfind('\n') + 1;  // npos + 1 is 0
  const std::string_view word = text_.substr(word_at_, word_size_);
  const std::string found = !word.empty()             ? quoted_word(word)
                            : word_at_ < text_.size() ? "the end of the line"
                                                      : "the end of the file";
  throw std::invalid_argument(file_.name + ":" + std::to_string(line) + ":" +
                              std::to_string(word_at_ - start + 1) + ": found " + found + "; expected " +
                              expected);
}

void fail_at_byte(const MeshBytes& file, std::size_t byte, const std::string& found,
                  const std::string& expected) {
  throw std::invalid_argument(file.name + ": byte " + std::to_string(byte) + ": found " + found +
                              "; expected " + expected);
}

std::string quoted_word(std::string_view word) {
  constexpr std::size_t max = 40;
  const bool long_word = word.size() > max;
  return "\"" + escaped(word.substr(0, max)) + (long_word ? "..." : "") + "\"";
}

}  // namespace pliant
