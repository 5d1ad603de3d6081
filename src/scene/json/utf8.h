// Strict decoding of UTF-8: overlong forms, surrogates and code points above U+10FFFF are invalid.
#pragma once

#include <cstddef>
#include <string_view>

namespace pliant::utf8 {

/// Returns the number of bytes of the character at `at`, or 0 if the bytes there are not UTF-8.
std::size_t length(std::string_view text, std::size_t at);

/// Returns the character at `at`; length() must not be 0 there.
char32_t decode(std::string_view text, std::size_t at);

}  // namespace pliant::utf8
