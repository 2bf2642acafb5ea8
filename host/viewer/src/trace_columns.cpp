#include "trace_columns.hpp"

#include <algorithm>
#include <vector>

#include "tactree/support/csv.hpp"

namespace tactree::viewer {

std::string without_columns(std::string_view csv, std::initializer_list<std::string_view> names) {
  std::vector<bool> kept;
  for (const std::string_view name : support::split_csv(csv.substr(0, csv.find('\n')))) {
    kept.push_back(std::find(names.begin(), names.end(), name) == names.end());
  }
  std::string result;
  while (!csv.empty()) {
    const std::size_t end = csv.find('\n');
    const std::vector<std::string_view> cells = support::split_csv(csv.substr(0, end));
    const char* separator = "";
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (kept[i]) {
        result.append(separator).append(cells[i]);
        separator = ",";
      }
    }
    result += '\n';
    csv.remove_prefix(end == std::string_view::npos ? csv.size() : end + 1);
  }
  return result;
}

}  // namespace tactree::viewer
