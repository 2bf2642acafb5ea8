#include "tactree/hal/linux/pwm_motors.hpp"

#include <fcntl.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace tactree::hal::linux_gpio {
namespace {

namespace fs = std::filesystem;

constexpr int kPatience = 1000;  // ms: udev gives the files of a new channel to their group

std::string quoted(const std::string& name) { return "PWM chip '" + name + "'"; }

/// A value of sysfs: one write is one value.
bool write_value(int file, std::uint32_t value) noexcept {
  std::array<char, 16> text{};
  char* const end = std::to_chars(text.data(), text.data() + text.size() - 1, value).ptr;
  *end = '\n';
  const auto size = static_cast<std::size_t>(end + 1 - text.data());
  return ::pwrite(file, text.data(), size, 0) == static_cast<ssize_t>(size);
}

FileDescriptor open_value(const std::string& file) {
  FileDescriptor opened(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
  for (int i = 0; i < kPatience && opened.get() < 0; ++i) {  // bound: kPatience
    ::usleep(1000);
    opened = FileDescriptor(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
  }
  if (opened.get() < 0) {
    throw PwmError(file + ": " + std::strerror(errno) +
                   " (remedy: join the group that owns it, or run as root)");
  }
  return opened;
}

void set_value(const std::string& file, std::uint32_t value) {
  const FileDescriptor opened = open_value(file);
  if (!write_value(opened.get(), value)) {
    throw PwmError(file + ": " + std::to_string(value) + ": " + std::strerror(errno) +
                   " (remedy: a period that this chip can make, and channels that are free)");
  }
}

/// What a chip's number does not tell: the device it is in.
std::string device_of(const fs::path& chip) {
  std::error_code error;
  return fs::read_symlink(chip / "device", error).filename().string();
}

std::uint32_t share_of(float effort, float full, std::uint32_t period_ns) {
  const float share = (effort < 0.0F ? -effort : effort) / full;
  if (!(share > 0.0F)) {
    return 0;  // also what is no number
  }
  return share < 1.0F
             ? static_cast<std::uint32_t>(std::lround(share * static_cast<float>(period_ns)))
             : period_ns;
}

std::vector<std::string> directions_of(const MotorSettings& settings) {
  if (settings.axes.empty() || settings.axes.size() > core::kAxes) {
    throw PwmError(
        "motors: one to three axes are wanted (remedy: name chip and direction of each)");
  }
  std::vector<std::string> names;
  for (const MotorLines& axis : settings.axes) {  // bound: kAxes
    names.push_back(axis.direction);
  }
  return names;
}

}  // namespace

std::string find_pwm_chip(const std::string& root, const std::string& name, std::uint32_t channel) {
  std::error_code error;
  std::string others;
  for (const auto& entry : fs::directory_iterator(root, error)) {  // bound: chips
    const std::string device = device_of(entry.path());
    if (device != name) {
      others += (others.empty() ? "" : ", ") + device;
      continue;
    }
    std::uint32_t channels = 0;
    std::ifstream(entry.path() / "npwm") >> channels;
    if (channel >= channels) {
      throw PwmError(quoted(name) + ": it has no channel " + std::to_string(channel) +
                     " (remedy: it has " + std::to_string(channels) + ", from 0)");
    }
    return entry.path().string();
  }
  if (error || others.empty()) {
    throw PwmError(quoted(name) + ": there is no PWM chip in " + root +
                   " (remedy: enable it in the device tree)");
  }
  throw PwmError(quoted(name) + ": no chip in " + root +
                 " has a device of that name (remedy: " + "name one of: " + others + ")");
}

PwmChannel::PwmChannel(const std::string& root, const std::string& chip, std::uint32_t channel,
                       std::uint32_t period_ns)
    : chip_(find_pwm_chip(root, chip, channel)), channel_(channel) {
  const std::string folder = chip_ + "/pwm" + std::to_string(channel);
  if (!fs::exists(folder)) {  // else of a program before us that did not tidy up
    set_value(chip_ + "/export", channel);
  }
  width_ = open_value(folder + "/duty_cycle");
  (void)write_value(width_.get(), 0);  // a channel that has no period yet refuses
  set_value(folder + "/period", period_ns);
  set_value(folder + "/duty_cycle", 0);
  set_value(folder + "/enable", 1);
}

PwmChannel::~PwmChannel() {
  if (width_.get() >= 0) {
    width_ns_ = 1;
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
      period_ns_(settings.period_ns) {
  for (const MotorLines& axis : settings.axes) {  // bound: kAxes
    full_.push_back(axis.effort_at_full_width);
    channels_.emplace_back(settings.pwm_root, axis.chip, axis.channel, settings.period_ns);
  }
  if (!settings.good.empty()) {
    InputSettings input;
    input.bias = Bias::kPullDown;  // a broken wire is a failure
    good_.emplace(GpioLines::inputs({settings.good}, consumer, input));
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

bool PwmMotors::healthy() noexcept {
  std::uint64_t good = 1;
  const bool told = !good_ || good_->levels(good);
  return delivered_ && told && good != 0U;
}

void PwmMotors::release() noexcept {
  for (PwmChannel& channel : channels_) {  // bound: kAxes
    delivered_ = channel.set_width(0) && delivered_;
  }
}

}  // namespace tactree::hal::linux_gpio
