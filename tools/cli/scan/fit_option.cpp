#include "scan/fit_option.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "run/model_size.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

constexpr char kDevice[] = "device";

void fit_to_device(const std::string& name, builder::BuildOptions& build) {
  const core::DeviceModel device = support::load_device(name).preset.model;
  if (core::axes_of(device.kind) != core::kAxes) {
    support::refuse("--fit device:" + name,
                    "not possible for a device of one or two axes, which touches a section of a "
                    "model of any size",
                    "give a length in metres");
  }
  build.fit_edge_m = [device, name](const Eigen::Vector3d& size) {
    const std::optional<double> scale = fitting_scale(device, size);
    if (!scale) {
      support::refuse("--fit device:" + name,
                      "the origin of the device is not inside its workspace", "correct the device");
    }
    return *scale * size.maxCoeff();
  };
}

}  // namespace

void set_fit(const std::string& text, builder::BuildOptions& build) {
  if (text == kDevice) {
    fit_to_device("premium", build);
    return;
  }
  if (text.starts_with(std::string(kDevice) + ":")) {
    fit_to_device(text.substr(sizeof kDevice), build);
    return;
  }
  double length_m = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), length_m);
  if (error != std::errc{} || rest != text.data() + text.size() || !std::isfinite(length_m) ||
      !(length_m > 0.0)) {
    throw CLI::ValidationError(
        "--fit", fmt::format("'{}' is neither a length in metres nor device:NAME", text));
  }
  build.fit_m = length_m;
}

}  // namespace tactree::cli
