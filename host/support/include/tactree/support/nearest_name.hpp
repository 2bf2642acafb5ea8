#pragma once
// Suggestions for misspelled names.

#include <string>
#include <vector>

namespace tactree::support {

/// Returns the name with the fewest edits (insertions, deletions, replacements, swaps of adjacent
/// characters) from `word`, the first of equally near ones; empty if none is similar.
[[nodiscard]] std::string nearest_name(const std::string& word,
                                       const std::vector<std::string>& names);

}  // namespace tactree::support
