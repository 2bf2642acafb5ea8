// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/converter_motors.hpp"

#include <fcntl.h>

#include <cmath>
#include <filesystem>

#include "sysfs.hpp"

namespace tactree::hal::linux_gpio {
namespace {

constexpr char kConverter[] = "converter";

}  // namespace

std::string find_converter(const std::string& root, const ConverterAxis& axis) {
  const std::string folder = find_sysfs_device(root, axis.device, kConverter);
  std::string file = folder + "/out_voltage" + std::to_string(axis.channel) + "_raw";
  if (!std::filesystem::exists(file)) {
    throw SysfsError(quoted(kConverter, axis.device) + ": it has no output " +
                     std::to_string(axis.channel) +
                     " (hint: use one of the files out_voltage*_raw "
                     "in " +
                     folder + ")");
  }
  return file;
}

std::int32_t code_of(const ConverterAxis& axis, float effort) {
  const float share = effort / axis.effort_at_full;
  if (!(share < 0.0F) && !(share > 0.0F)) {
    return axis.zero_code;  // also for NaN
  }
  const float held = share > 1.0F ? 1.0F : share < -1.0F ? -1.0F : share;
  const double span = static_cast<double>(axis.full_code) - static_cast<double>(axis.zero_code);
  return axis.zero_code + static_cast<std::int32_t>(std::lround(static_cast<double>(held) * span));
}

ConverterMotors::ConverterMotors(const ConverterSettings& settings, const std::string& consumer)
    : good_(settings.good, consumer) {
  if (settings.axes.empty() || settings.axes.size() > core::kAxes) {
    throw SysfsError("motors: one to three axes are required (hint: name the converter of each)");
  }
  for (const ConverterAxis& axis : settings.axes) {  // bound: kAxes
    const std::string file = find_converter(settings.root, axis);
    set_value(file, axis.zero_code, "a zero_code within the converter's range");
    outputs_.push_back({axis, open_value(file, O_WRONLY), axis.zero_code});
  }
}

void ConverterMotors::give(Output& output, std::int32_t code) noexcept {
  if (code != output.code) {
    output.code = code;
    delivered_ = write_value(output.file.get(), code) && delivered_;
  }
}

void ConverterMotors::write(const core::MotorCommand& command) noexcept {
  for (std::uint32_t i = 0; i < outputs_.size(); ++i) {  // bound: kAxes
    give(outputs_[i], code_of(outputs_[i].axis, command.effort(i)));
  }
}

bool ConverterMotors::healthy() noexcept { return delivered_ && good_.read(); }

void ConverterMotors::release() noexcept {
  for (Output& output : outputs_) {  // bound: kAxes
    give(output, output.axis.zero_code);
  }
}

}  // namespace tactree::hal::linux_gpio
