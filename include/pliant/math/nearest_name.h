// The name a user probably meant: for messages about unknown keys, functions, shapes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// Number of letters to insert, delete, replace, or of neighbours to swap, that turns one word into the
/// other; lower and upper case count as equal.
int edit_distance(std::string_view a, std::string_view b);

/// The name at the least edit distance from `wrong`, the first of several; empty when none is within 2
/// (within 1 for words of at most two letters).
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names);

/// "; did you mean "NAME"?" or nothing: the tail of a message about an unknown name.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace pliant
