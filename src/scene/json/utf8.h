// UTF-8, strictly: no overlong forms, no surrogates, nothing above U+10FFFF.
#pragma once

#include <cstddef>
#include <string_view>

namespace pliant::utf8 {

/// Bytes of the character that begins at `at`; 0 when the bytes there are not UTF-8.
std::size_t length(std::string_view text, std::size_t at);

/// The character that begins at `at`, where length() is not 0.
char32_t decode(std::string_view text, std::size_t at);

}  // namespace pliant::utf8
