#include "option_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

namespace tactree::cli {
namespace {

bool is_finite(const std::string& text, double& value) {
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value);
}

}  // namespace

CLI::Validator within(double low, double high) {
  const CLI::Range range(low, high);
  return {[range](std::string& text) -> std::string {
            double value = 0.0;
            return is_finite(text, value) ? range(text)
                                          : fmt::format("'{}' is not a finite number", text);
          },
          range.get_description()};
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

}  // namespace tactree::cli
