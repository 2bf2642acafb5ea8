#include "run/model_size.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>

#include "tactree/simulation/workspace.hpp"

namespace tactree::cli {
namespace {

/// Rounded down.
double two_digits(double length_m) {
  const double unit = std::pow(10.0, std::floor(std::log10(length_m)) - 1.0);
  return unit * std::floor(length_m / unit);
}

}  // namespace

std::optional<std::string> oversize_warning(const std::string& file, const core::BlobHeader& model,
                                            const std::string& device_name,
                                            const core::DeviceModel& device) {
  const Eigen::Vector3d size =
      (Eigen::Vector3f(model.bounds_max_m) - Eigen::Vector3f(model.bounds_min_m)).cast<double>();
  if (simulation::reaches_box(device, size)) {
    return std::nullopt;
  }
  const Eigen::Vector3d size_mm = 1e3 * size;
  const std::string place = fmt::format("{}: the model is {:.4g} x {:.4g} x {:.4g} mm", file,
                                        size_mm.x(), size_mm.y(), size_mm.z());
  const double longest_m = simulation::largest_scale(device, size).value_or(0.0) * size.maxCoeff();
  if (!(longest_m > 0.0)) {
    return fmt::format("{}: {} does not reach the places around its origin (correct the device)",
                       place, device_name);
  }
  return fmt::format(
      "{}: larger than {} reaches; of that shape up to {:.2g} m (build it with --fit device:{})",
      place, device_name, two_digits(longest_m), device_name);
}

}  // namespace tactree::cli
