// Where the tokens of a JSON text begin and end.
#pragma once

#include <cstddef>
#include <string_view>

namespace pliant::json {

/// The first byte from `at` on that is not white space.
std::size_t skip_space(std::string_view text, std::size_t at);

/// Just behind the closing quote of the string whose opening quote is at `at`; the end of the text when it
/// has none.
std::size_t string_end(std::string_view text, std::size_t at);

/// Just behind the number, true, false or null that begins at `at`, by the grammar of JSON.
std::size_t scalar_end(std::string_view text, std::size_t at);

/// Just behind all that stands at `at` without white space or punctuation: what a user takes for one word.
std::size_t word_end(std::string_view text, std::size_t at);

/// The byte of the text that holds byte number `byte` of the decoded string whose opening quote is at `at`.
std::size_t string_byte(std::string_view text, std::size_t at, std::size_t byte);

/// Four hexadecimal digits at `at`; -1 when they are not.
int hex4(std::string_view text, std::size_t at);

}  // namespace pliant::json
