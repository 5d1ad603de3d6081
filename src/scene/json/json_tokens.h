// Offsets at which the tokens of a JSON text begin and end.
#pragma once

#include <cstddef>
#include <string_view>

namespace pliant::json {

/// Returns the offset of the first byte, from `at` on, that is not white space, or the end of the text.
std::size_t skip_space(std::string_view text, std::size_t at);

/// Returns the offset after the closing quote of the string whose opening quote is at `at`, or the end of the
/// text if there is no closing quote.
std::size_t string_end(std::string_view text, std::size_t at);

/// Returns the offset after the number, true, false or null at `at`, by the grammar of JSON.
std::size_t scalar_end(std::string_view text, std::size_t at);

/// Returns the offset after the word at `at`: the offset of the next white space, quote, slash, NUL or
/// punctuation of JSON, or the end of the text.
std::size_t word_end(std::string_view text, std::size_t at);

/// Returns the offset in the text of byte number `byte` (counted from 0) of a decoded string. at: offset of
/// the opening quote.
std::size_t string_byte(std::string_view text, std::size_t at, std::size_t byte);

/// Returns the value of the four hexadecimal digits at `at`, or -1 if there are not four digits.
int hex4(std::string_view text, std::size_t at);

}  // namespace pliant::json
