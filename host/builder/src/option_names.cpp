#include "tactree/builder/option_names.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace tactree::builder {
namespace {

constexpr std::uint64_t kLeastMemoryLimit = 32U << 20U;

void require_positive(const char* option, const std::optional<double>& value) {
  if (value && !(*value > 0.0 && std::isfinite(*value))) {
    throw OptionError(option, "must be positive");
  }
}

void check_crop(const Eigen::AlignedBox3d& crop) {
  if (!(crop.min().array() < crop.max().array()).all()) {
    throw OptionError("crop", "requires xmin,ymin,zmin,xmax,ymax,zmax with min < max");
  }
}

}  // namespace

const std::map<std::string, double>& unit_names() {
  static const std::map<std::string, double> kNames{{"m", 1.0},   {"cm", 1e-2},   {"mm", 1e-3},
                                                    {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}};
  return kNames;
}

const std::map<std::string, UpAxis>& axis_names() {
  static const std::map<std::string, UpAxis> kNames{
      {"x", UpAxis::kX}, {"y", UpAxis::kY}, {"z", UpAxis::kZ}};
  return kNames;
}

const std::map<std::string, OrientationRule>& orientation_names() {
  static const std::map<std::string, OrientationRule> kNames{
      {"auto", OrientationRule::kAuto},
      {"outward", OrientationRule::kOutward},
      {"viewpoint", OrientationRule::kViewpoint},
      {"up", OrientationRule::kUp},
      {"given", OrientationRule::kGiven}};
  return kNames;
}

const std::map<std::string, core::Profile>& profile_names() {
  static const std::map<std::string, core::Profile> kNames{{"surface", core::Profile::kSurface},
                                                           {"paper", core::Profile::kPaper}};
  return kNames;
}

void check_options(const BuildOptions& options) {
  require_positive("unit", options.unit_m);
  require_positive("scale", options.scale);
  require_positive("pose", options.placed_scale);
  require_positive("fit", options.fit_m);
  require_positive("two-sided", options.two_sided_m);
  require_positive("spacing", options.spacing_m);
  if (!(std::abs(options.turn_deg) <= 360.0)) {
    throw OptionError("turn", fmt::format("{} degrees is outside -360 .. 360", options.turn_deg));
  }
  if (options.crop) {
    check_crop(*options.crop);
  }
  if (options.flash_budget_bytes && (!options.resample || options.spacing_m)) {
    throw OptionError(
        "flash-budget",
        "cannot be combined with --spacing or --no-resample, because it chooses the spacing");
  }
  if (options.memory_limit_bytes != 0 && options.memory_limit_bytes < kLeastMemoryLimit) {
    throw OptionError("memory-limit",
                      fmt::format("{} bytes are less than 32 MiB", options.memory_limit_bytes));
  }
  if (options.outlier_sigma != 0.0 && !(options.outlier_sigma >= 1.0)) {
    throw OptionError("outliers", fmt::format("'{}' is neither off nor a number of at least 1",
                                              options.outlier_sigma));
  }
}

}  // namespace tactree::builder
