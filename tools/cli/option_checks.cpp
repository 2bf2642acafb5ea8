#include "option_checks.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

namespace tactree::cli {
namespace {

bool is_finite(const std::string& text, double& value) {
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value);
}

}  // namespace

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
