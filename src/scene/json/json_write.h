// Conversion of strings and numbers to JSON text, for messages and files.
#pragma once

#include <string>
#include <string_view>

namespace pliant {

/// Returns the text as a JSON string with quotes and escapes; bytes that are not UTF-8 become U+FFFD.
std::string json_string(std::string_view text);

/// Returns the shortest decimal text that reads back as x.
std::string shortest(double x);

}  // namespace pliant
