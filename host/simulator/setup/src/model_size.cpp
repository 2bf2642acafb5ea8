#include "tactree/setup/model_size.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "tactree/builder/length_text.hpp"
#include "tactree/builder/size_advice.hpp"
#include "tactree/simulation/workspace.hpp"

namespace tactree::setup {
namespace {

// Ratio of the size to the maximum size that the device reaches; leaves room for the probe around
// the model.
constexpr double kShare = 0.95;

/// Rounds a length down to two significant digits.
double two_digits(double length_m) {
  const double unit = std::pow(10.0, std::floor(std::log10(length_m)) - 1.0);
  return unit * std::floor(length_m / unit);
}

Eigen::Vector3d centre_of(const core::BlobHeader& model) {
  return 0.5 *
         (Eigen::Vector3f(model.bounds_max_m) + Eigen::Vector3f(model.bounds_min_m)).cast<double>();
}

}  // namespace

Eigen::Vector3d size_of(const core::BlobHeader& model) {
  return (Eigen::Vector3f(model.bounds_max_m) - Eigen::Vector3f(model.bounds_min_m)).cast<double>();
}

std::optional<double> fitting_scale(const core::DeviceModel& device,
                                    const Eigen::Vector3d& size_m) {
  const double scale = simulation::largest_scale(device, size_m).value_or(0.0);
  return scale > 0.0 ? std::optional(kShare * scale) : std::nullopt;
}

std::optional<std::string> oversize_warning(const std::string& file, const core::BlobHeader& model,
                                            const std::string& device_name,
                                            const core::DeviceModel& device) {
  const Eigen::Vector3d size = size_of(model);
  if (simulation::reaches_box(device, size)) {
    return std::nullopt;
  }
  const std::string place = fmt::format("{}: the model is {}", file, builder::size_text(size));
  const double longest_m = simulation::largest_scale(device, size).value_or(0.0) * size.maxCoeff();
  if (!(longest_m > 0.0)) {
    return fmt::format("{}; the origin of {} is not inside its workspace (correct the device)",
                       place, device_name);
  }
  return fmt::format(
      "{}, more than {} reaches; it fits with a longest edge of up to {} (build it with --fit "
      "device:{})",
      place, device_name, builder::length_text(two_digits(longest_m), 2), device_name);
}

std::optional<std::string> misplaced_warning(const std::string& file, const core::BlobHeader& model,
                                             const std::string& device_name,
                                             const core::DeviceModel& device,
                                             const Eigen::Isometry3d& pose) {
  const Eigen::Isometry3d box = pose * Eigen::Translation3d(centre_of(model));
  if (simulation::reaches_box(device, box, size_of(model))) {
    return std::nullopt;
  }
  return fmt::format(
      "{}: {} does not reach all of the model where it is placed (move it on the page of tactree "
      "view, or build it with --fit device:{})",
      file, device_name, device_name);
}

std::optional<simulation::Placement> fitted_placement(const core::DeviceModel& device,
                                                      const core::BlobHeader& model,
                                                      const simulation::Placement& now) {
  // The box around the turned box of the model.
  const Eigen::Vector3d size = now.pose.linear().cwiseAbs() * size_of(model);
  const std::optional<double> largest = fitting_scale(device, size);
  if (!largest) {
    return std::nullopt;
  }
  simulation::Placement fitted = now;
  fitted.scale = std::min(now.scale, *largest);
  fitted.pose.translation() = now.pose.linear() * (-fitted.scale * centre_of(model));
  return fitted;
}

std::optional<std::string> size_warning(const std::string& file, const core::BlobHeader& model) {
  const std::optional<std::string> advice = builder::size_advice(size_of(model).maxCoeff());
  return advice ? std::optional(file + ": " + *advice) : std::nullopt;
}

}  // namespace tactree::setup
