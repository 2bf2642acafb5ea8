#pragma once
// Names of the values of BuildOptions, for command lines and other languages, and the check of
// their ranges.

#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Metres per unit: m, cm, mm, um, in, ft.
[[nodiscard]] const std::map<std::string, double>& unit_names();
[[nodiscard]] const std::map<std::string, UpAxis>& axis_names();
[[nodiscard]] const std::map<std::string, OrientationRule>& orientation_names();
[[nodiscard]] const std::map<std::string, core::Profile>& profile_names();

/// A value that build_model() cannot use.
class OptionError : public std::invalid_argument {
 public:
  OptionError(std::string option, const std::string& cause)
      : std::invalid_argument(cause), option_(std::move(option)) {}
  /// Name of the option of `tactree build`, without dashes in front.
  [[nodiscard]] const std::string& option() const { return option_; }

 private:
  std::string option_;
};

/// Throws OptionError.
void check_options(const BuildOptions& options);

}  // namespace tactree::builder
