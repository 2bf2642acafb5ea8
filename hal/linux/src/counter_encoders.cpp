// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/counter_encoders.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "sysfs.hpp"

namespace tactree::hal::linux_gpio {
namespace {

constexpr char kCounter[] = "counter";
constexpr char kEachEdge[] = "quadrature x4";

std::string function_of(const std::string& folder) {
  std::string text;
  std::getline(std::ifstream(folder + "/function"), text);
  return text;
}

/// Selects counting of every edge of both channels.
void count_each_edge(const std::string& folder) {
  if (function_of(folder) != kEachEdge) {
    std::ofstream(folder + "/function") << kEachEdge << std::flush;
  }
  if (function_of(folder) != kEachEdge) {
    throw SysfsError(folder + "/function: does not accept '" + kEachEdge +
                     "' (hint: run as root, or use a counter that supports it)");
  }
}

/// Sets the largest range that the counter accepts and returns its number of values; the counter
/// wraps after `ceiling`. Some counters start with an empty range.
std::uint64_t widen(const std::string& folder) {
  const std::string file = folder + "/ceiling";
  if (::access(file.c_str(), W_OK) == 0) {
    const FileDescriptor opened = open_value(file, O_WRONLY);
    for (const std::int64_t ceiling : {0xFFFFFFFFLL, 0xFFFFFFLL, 0xFFFFLL}) {  // bound: 3
      if (write_value(opened.get(), ceiling)) {
        break;
      }
    }
  }
  std::int64_t ceiling = 0;
  if (!read_value(open_value(file, O_RDONLY).get(), ceiling) || ceiling < 0xFF) {
    throw SysfsError(file + ": has no valid counting range (hint: use another counter)");
  }
  return static_cast<std::uint64_t>(ceiling) + 1U;
}

void start(const std::string& folder) {
  const std::string file = folder + "/enable";
  if (std::filesystem::exists(file)) {  // a counter that always counts has no such file
    set_value(file, 1, "run as root");
  }
}

}  // namespace

std::string find_count(const std::string& root, const CounterAxis& axis) {
  const std::string counter = find_sysfs_device(root, axis.device, kCounter);
  std::string folder = counter + "/count" + std::to_string(axis.count);
  if (!std::filesystem::exists(folder)) {
    throw SysfsError(quoted(kCounter, axis.device) + ": it has no count " +
                     std::to_string(axis.count) +
                     " (hint: use one of the folders count0, count1 ... in " + counter + ")");
  }
  return folder;
}

CounterEncoderBank::CounterEncoderBank(const CounterSettings& settings) {
  if (settings.axes.empty() || settings.axes.size() > core::kAxes) {
    throw SysfsError("encoders: one to three axes are required (hint: name the counter of each)");
  }
  for (const CounterAxis& named : settings.axes) {  // bound: kAxes
    const std::string folder = find_count(settings.root, named);
    count_each_edge(folder);
    Axis axis;
    axis.range = widen(folder);
    start(folder);
    axis.file = open_value(folder + "/count", O_RDONLY);
    std::int64_t now = 0;
    if (!read_value(axis.file.get(), now) || now < 0 ||
        static_cast<std::uint64_t>(now) >= axis.range) {
      throw SysfsError(folder + "/count: has no valid count (hint: use another counter)");
    }
    axis.last = static_cast<std::uint64_t>(now);
    axes_.push_back(std::move(axis));
  }
}

void CounterEncoderBank::advance(Axis& axis) noexcept {
  std::int64_t now = 0;
  axis.valid = axis.valid && read_value(axis.file.get(), now) && now >= 0 &&
               static_cast<std::uint64_t>(now) < axis.range;
  if (!axis.valid) {
    return;
  }
  const auto count = static_cast<std::uint64_t>(now);
  const std::uint64_t forth =
      count >= axis.last ? count - axis.last : count + axis.range - axis.last;
  const bool back = forth > axis.range / 2U;
  axis.count += static_cast<std::uint32_t>(back ? forth - axis.range : forth);
  axis.last = count;
}

core::EncoderReading CounterEncoderBank::read() noexcept {
  core::EncoderReading reading;
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {  // bound: kAxes
    reading.valid[i] = true;
    if (i < axes_.size()) {
      advance(axes_[i]);
      reading.counts[i] = static_cast<std::int32_t>(axes_[i].count);
      reading.valid[i] = axes_[i].valid;
    }
  }
  return reading;
}

}  // namespace tactree::hal::linux_gpio
