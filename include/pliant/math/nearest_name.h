// The known name that is nearest to a misspelled name, for messages about unknown keys, functions or shapes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// Returns the edit distance of two words: the smallest number of insertions, deletions, replacements and
/// swaps of neighbouring letters that turn one word into the other, where no swapped letter is edited again.
/// Case is ignored.
int edit_distance(std::string_view a, std::string_view b);

/// Returns the name with the smallest edit distance from `wrong`; of equally near names, the first. Returns
/// an empty text if no name is within distance 2, or within distance 1 if `wrong` has at most two letters.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names);

/// Returns the end of a message about an unknown name: "; did you mean "NAME"?", or an empty text if no name
/// is near.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace pliant
