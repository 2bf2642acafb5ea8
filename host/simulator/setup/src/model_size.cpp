#include "tactree/setup/model_size.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tactree/builder/length_text.hpp"
#include "tactree/builder/size_advice.hpp"
#include "tactree/plant/vectors.hpp"
#include "tactree/simulation/workspace.hpp"
#include "tactree/support/blob_file.hpp"

namespace tactree::setup {
namespace {

// Ratio of the size to the maximum size that the device reaches; leaves room for the probe around
// the model.
constexpr double kShare = 0.95;

// Positions that are examined for a device of one or two axes: the nearest ones, and as many
// others.
constexpr std::size_t kSamples = 200;

/// Rounds a length down to two significant digits.
double two_digits(double length_m) {
  const double unit = std::pow(10.0, std::floor(std::log10(length_m)) - 1.0);
  return unit * std::floor(length_m / unit);
}

Eigen::Vector3d centre_of(const core::BlobHeader& model) {
  return 0.5 *
         (Eigen::Vector3f(model.bounds_max_m) + Eigen::Vector3f(model.bounds_min_m)).cast<double>();
}

bool has_all_axes(const core::DeviceModel& device) {
  return core::axes_of(device.kind) == core::kAxes;
}

/// Where the probe of a device of one or two axes moves.
const char* path_of(const core::DeviceModel& device) {
  return device.kind == core::DeviceKind::kPaddle ? "on the arc" : "in the plane";
}

/// True if the position is within `distance_m` of the plane of a five-bar, or of the circle of a
/// paddle, whatever the ranges of the joints.
bool is_on_path(const core::DeviceModel& device, const Eigen::Vector3d& place_m,
                double distance_m) {
  const Eigen::Vector3d from_axis = place_m + plant::widen(device.origin_m);
  if (device.kind == core::DeviceKind::kFiveBar) {
    return std::abs(from_axis.x()) <= distance_m;
  }
  const double radius = std::hypot(from_axis.x(), from_axis.z());
  return std::abs(from_axis.y()) <= distance_m &&
         std::abs(radius - static_cast<double>(device.paddle_m)) <= distance_m;
}

/// The points of the surface on the path of the probe, device frame, those nearest to the device's
/// origin first.
std::vector<Eigen::Vector3d> section_of(const core::DeviceModel& device,
                                        const core::BlobView& model,
                                        const Eigen::Isometry3d& pose) {
  const auto near = static_cast<double>(model.header().support_radius_m);
  std::vector<Eigen::Vector3d> section;
  for (const core::SurfacePoint& point : support::decode_points(model)) {
    const Eigen::Vector3d place = pose * plant::widen(point.position);
    if (is_on_path(device, place, near)) {
      section.push_back(place);
    }
  }
  std::sort(section.begin(), section.end(),
            [](const auto& a, const auto& b) { return a.squaredNorm() < b.squaredNorm(); });
  return section;
}

enum class Met : std::uint8_t { kNothing, kPart, kAll };

/// How much of the surface the probe of a device of one or two axes meets.
Met met_surface(const core::DeviceModel& device, const core::BlobView& model,
                const Eigen::Isometry3d& pose) {
  const auto near = static_cast<double>(model.header().support_radius_m);
  const std::vector<Eigen::Vector3d> section = section_of(device, model, pose);
  const std::size_t step = 1U + section.size() / kSamples;
  bool all = !section.empty();
  bool any = false;
  for (std::size_t i = 0; i < section.size() && (all || !any); i += i < kSamples ? 1U : step) {
    const bool is_met = simulation::comes_near(device, section[i], near);
    all = all && is_met;
    any = any || is_met;
  }
  return all ? Met::kAll : any ? Met::kPart : Met::kNothing;
}

Met met_box(const core::DeviceModel& device, const core::BlobHeader& model,
            const Eigen::Isometry3d& pose) {
  const Eigen::Isometry3d box = pose * Eigen::Translation3d(centre_of(model));
  return simulation::reaches_box(device, box, size_of(model)) ? Met::kAll : Met::kPart;
}

/// Where a session puts a model that nobody has placed, device frame.
Eigen::Isometry3d usual_pose(const core::BlobHeader& model, const core::DeviceModel& device) {
  const Eigen::Isometry3d given = Eigen::Isometry3d::Identity();
  return simulation::in_device(given, simulation::middle_at_origin(model, given, device.kind));
}

/// The size of the model, and what the device does not reach of it. `met` is that of its surface.
std::string excess(const core::BlobHeader& model, const std::string& device_name,
                   const core::DeviceModel& device, Met met) {
  const std::string size = builder::size_text(size_of(model));
  if (has_all_axes(device)) {
    return fmt::format("{}, more than {} reaches", size, device_name);
  }
  const char* const path = path_of(device);
  return met == Met::kNothing
             ? fmt::format("{}, and {} does not reach its surface {} of its probe", size,
                           device_name, path)
             : fmt::format("{}, more than {} reaches {} of its probe", size, device_name, path);
}

std::string misplaced(const std::string& device_name, const core::DeviceModel& device, Met met) {
  const std::string what = met == Met::kPart
                               ? "all of the model"
                               : fmt::format("the model {} of its probe", path_of(device));
  return fmt::format(
      "{} does not reach {} where it is placed (move it on the page of tactree view, or build it "
      "with --fit device:{})",
      device_name, what, device_name);
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

std::optional<std::string> oversize_warning(const core::BlobView& model,
                                            const std::string& device_name,
                                            const core::DeviceModel& device) {
  const core::BlobHeader& header = model.header();
  const Eigen::Vector3d size = size_of(header);
  const bool fits = simulation::reaches_box(device, size);
  const Met met =
      has_all_axes(device) ? Met::kAll : met_surface(device, model, usual_pose(header, device));
  if (fits) {
    return met == Met::kNothing ? std::optional(misplaced(device_name, device, met)) : std::nullopt;
  }
  const double longest_m = simulation::largest_scale(device, size).value_or(0.0) * size.maxCoeff();
  if (!(longest_m > 0.0)) {
    return fmt::format(
        "the model is {}; the origin of {} is not inside its workspace (correct the device)",
        builder::size_text(size), device_name);
  }
  return fmt::format(
      "the model is {}; it fits with a longest edge of up to {} (build it with --fit device:{})",
      excess(header, device_name, device, met), builder::length_text(two_digits(longest_m), 2),
      device_name);
}

std::optional<std::string> misplaced_warning(const core::BlobView& model,
                                             const std::string& device_name,
                                             const core::DeviceModel& device,
                                             const Eigen::Isometry3d& pose) {
  const Met met = has_all_axes(device) ? met_box(device, model.header(), pose)
                                       : met_surface(device, model, pose);
  // A closed surface goes on where an arc leaves it.
  if (met == Met::kAll || (met == Met::kPart && device.kind == core::DeviceKind::kPaddle)) {
    return std::nullopt;
  }
  return misplaced(device_name, device, met);
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
  if (!has_all_axes(device)) {
    fitted.pose.translation().z() -= 0.5 * fitted.scale * size.z();
  }
  return fitted;
}

std::optional<std::string> size_warning(const std::string& file, const core::BlobHeader& model) {
  const std::optional<std::string> advice = builder::size_advice(size_of(model).maxCoeff());
  return advice ? std::optional(file + ": " + *advice) : std::nullopt;
}

}  // namespace tactree::setup
