// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/pwm_motors.hpp"

#include <fcntl.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "sysfs.hpp"

namespace tactree::hal::linux_gpio {
namespace {

namespace fs = std::filesystem;

constexpr char kPwmChip[] = "PWM chip";
constexpr char kRemedy[] = "use a period supported by this chip, and a free channel";

std::uint32_t share_of(float effort, float full, std::uint32_t period_ns) {
  const float share = (effort < 0.0F ? -effort : effort) / full;
  if (!(share > 0.0F)) {
    return 0;  // also for NaN
  }
  return share < 1.0F
             ? static_cast<std::uint32_t>(std::lround(share * static_cast<float>(period_ns)))
             : period_ns;
}

std::vector<std::string> directions_of(const MotorSettings& settings) {
  if (settings.axes.empty() || settings.axes.size() > core::kAxes) {
    throw SysfsError(
        "motors: one to three axes are required (hint: name chip and direction of each)");
  }
  std::vector<std::string> names;
  for (const MotorLines& axis : settings.axes) {  // bound: kAxes
    names.push_back(axis.direction);
  }
  return names;
}

}  // namespace

std::string find_pwm_chip(const std::string& root, const std::string& name, std::uint32_t channel) {
  std::string chip = find_sysfs_device(root, name, kPwmChip);
  std::uint32_t channels = 0;
  std::ifstream(chip + "/npwm") >> channels;
  if (channel >= channels) {
    throw SysfsError(quoted(kPwmChip, name) + ": it has no channel " + std::to_string(channel) +
                     " (hint: it has " + std::to_string(channels) + " channels, numbered from 0)");
  }
  return chip;
}

PwmChannel::PwmChannel(const std::string& root, const std::string& chip, std::uint32_t channel,
                       std::uint32_t period_ns)
    : chip_(find_pwm_chip(root, chip, channel)), channel_(channel) {
  const std::string folder = chip_ + "/pwm" + std::to_string(channel);
  if (!fs::exists(folder)) {  // otherwise a killed program left it exported
    set_value(chip_ + "/export", channel, kRemedy);
  }
  width_ = open_value(folder + "/duty_cycle", O_WRONLY);
  (void)write_value(width_.get(), 0);  // fails while the channel has no period
  set_value(folder + "/period", period_ns, kRemedy);
  set_value(folder + "/duty_cycle", 0, kRemedy);
  set_value(folder + "/enable", 1, kRemedy);
}

PwmChannel::~PwmChannel() {
  if (width_.get() >= 0) {
    width_ns_ = 1;  // differs from 0, so set_width() writes
    (void)set_width(0);
    const std::string folder = chip_ + "/pwm" + std::to_string(channel_);
    std::ofstream(folder + "/enable") << 0;
    std::ofstream(chip_ + "/unexport") << channel_;
  }
}

bool PwmChannel::set_width(std::uint32_t width_ns) noexcept {
  if (width_ns == width_ns_) {
    return true;
  }
  width_ns_ = width_ns;
  return write_value(width_.get(), width_ns);
}

PwmMotors::PwmMotors(const MotorSettings& settings, const std::string& consumer)
    : directions_(GpioLines::outputs(directions_of(settings), consumer, false)),
      good_(settings.good, consumer),
      period_ns_(settings.period_ns) {
  for (const MotorLines& axis : settings.axes) {  // bound: kAxes
    full_.push_back(axis.effort_at_full_width);
    channels_.emplace_back(settings.pwm_root, axis.chip, axis.channel, settings.period_ns);
  }
}

void PwmMotors::set_directions(std::uint64_t directions) noexcept {
  if (directions == negative_) {
    return;
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {  // bound: kAxes
    if ((((directions ^ negative_) >> i) & 1U) != 0U) {
      delivered_ = channels_[i].set_width(0) && delivered_;
    }
  }
  delivered_ = directions_.set(directions) && delivered_;
  negative_ = directions;
}

void PwmMotors::write(const core::MotorCommand& command) noexcept {
  std::uint64_t negative = 0;
  for (std::uint32_t i = 0; i < channels_.size(); ++i) {  // bound: kAxes
    negative |= command.effort(i) < 0.0F ? std::uint64_t{1} << i : 0U;
  }
  set_directions(negative);
  for (std::uint32_t i = 0; i < channels_.size(); ++i) {  // bound: kAxes
    const std::uint32_t width = share_of(command.effort(i), full_[i], period_ns_);
    delivered_ = channels_[i].set_width(width) && delivered_;
  }
}

bool PwmMotors::healthy() noexcept { return delivered_ && good_.read(); }

void PwmMotors::release() noexcept {
  for (PwmChannel& channel : channels_) {  // bound: kAxes
    delivered_ = channel.set_width(0) && delivered_;
  }
}

}  // namespace tactree::hal::linux_gpio
