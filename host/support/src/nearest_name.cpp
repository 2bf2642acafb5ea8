#include "tactree/support/nearest_name.hpp"

#include <algorithm>
#include <cstddef>

namespace tactree::support {
namespace {

constexpr std::size_t kMaxCharacters = 64;  // longer words are not compared, which bounds the cost

/// Optimal string alignment distance.
std::size_t edits(const std::string& from, const std::string& to) {
  std::vector<std::vector<std::size_t>> fewest(from.size() + 1U,
                                               std::vector<std::size_t>(to.size() + 1U));
  for (std::size_t i = 0; i <= from.size(); ++i) {
    for (std::size_t j = 0; j <= to.size(); ++j) {
      if (i == 0 || j == 0) {
        fewest[i][j] = i + j;
        continue;
      }
      const std::size_t replaced = fewest[i - 1][j - 1] + (from[i - 1] == to[j - 1] ? 0U : 1U);
      fewest[i][j] = std::min({fewest[i - 1][j] + 1U, fewest[i][j - 1] + 1U, replaced});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1]) {
        fewest[i][j] = std::min(fewest[i][j], fewest[i - 2][j - 2] + 1U);
      }
    }
  }
  return fewest.back().back();
}

}  // namespace

std::string nearest_name(const std::string& word, const std::vector<std::string>& names) {
  if (word.size() > kMaxCharacters) {
    return "";
  }
  std::string nearest;
  std::size_t fewest = std::max<std::size_t>(3, word.size() / 2U + 1U);
  for (const std::string& name : names) {
    if (const std::size_t count = edits(word, name); count < fewest) {
      fewest = count;
      nearest = name;
    }
  }
  return nearest;
}

}  // namespace tactree::support
