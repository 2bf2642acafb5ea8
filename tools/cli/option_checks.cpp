#include "option_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

bool is_finite(const std::string& text, double& value) {
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value);
}

}  // namespace

CLI::Validator within(double low, double high) {
  return {[low, high](const std::string& text) -> std::string {
            double value = 0.0;
            if (!is_finite(text, value)) {
              return fmt::format("'{}' is not a finite number", text);
            }
            return value >= low && value <= high
                       ? ""
                       : fmt::format("'{}' is not from {} to {}", text, low, high);
          },
          fmt::format("{} .. {}", low, high)};
}

CLI::Validator one_of(const std::vector<std::string>& names) {
  const std::string shown = fmt::format("{}", fmt::join(names, "|"));
  return {[names, shown](std::string& text) -> std::string {
            const std::string lower = CLI::detail::to_lower(text);
            const auto found = std::find_if(names.begin(), names.end(), [&](const auto& name) {
              return CLI::detail::to_lower(name) == lower;
            });
            if (found == names.end()) {
              return fmt::format("'{}' is not {}", text, listed(shown));
            }
            text = *found;
            return "";
          },
          shown};
}

CLI::Validator existing_file() {
  return {[](const std::string& file) -> std::string {
            std::error_code other;  // than a missing file: the reader states it
            const std::filesystem::file_status status = std::filesystem::status(file, other);
            if (status.type() == std::filesystem::file_type::not_found) {
              throw support::UserError(file + ": there is no such file (check the path)");
            }
            if (std::filesystem::is_directory(status)) {
              throw support::UserError(file + ": is a folder (give the file in it)");
            }
            return "";
          },
          "FILE"};
}

CLI::Validator written_as(const std::string& extension) {
  return {[extension](const std::string& file) -> std::string {
            constexpr const char* kOthers[] = {".csv", ".npz", ".svg",  ".png",  ".jpg", ".jpeg",
                                               ".pdf", ".gif", ".json", ".html", ".md"};
            const std::string given = std::filesystem::path(file).extension().string();
            const bool other =
                given != extension &&
                std::find(std::begin(kOthers), std::end(kOthers), given) != std::end(kOthers);
            return other ? fmt::format("'{}' is written as {} (give it that extension)", file,
                                       extension)
                         : "";
          },
          ""};
}

std::string is_positive(const std::string& text) {
  double value = 0.0;
  return is_finite(text, value) && value > 0.0 ? ""
                                               : fmt::format("'{}' is not a number above 0", text);
}

std::string is_not_negative(const std::string& text) {
  double value = 0.0;
  return is_finite(text, value) && value >= 0.0
             ? ""
             : fmt::format("'{}' is not a number from 0 upwards", text);
}

std::string listed(std::string names) {
  const std::size_t last = names.rfind('|');
  if (last != std::string::npos) {
    names.replace(last, 1, " or ");
  }
  for (std::size_t at = names.find('|'); at != std::string::npos; at = names.find('|')) {
    names.replace(at, 1, ", ");
  }
  return names;
}

}  // namespace tactree::cli
