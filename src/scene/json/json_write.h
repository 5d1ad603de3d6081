// JSON and number text for messages and for files.
#pragma once

#include <string>
#include <string_view>

namespace pliant {

/// The text in quotes, escaped; bytes that are not UTF-8 become U+FFFD.
std::string json_string(std::string_view text);

/// The shortest decimal text that reads back as x.
std::string shortest(double x);

}  // namespace pliant
