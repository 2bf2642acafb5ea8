#include "tactree/hal/linux/gpio_lines.hpp"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "tactree/hal/linux/file_descriptor.hpp"

namespace tactree::hal::linux_gpio {
namespace {

constexpr std::size_t kEdgesAtOnce = 64;

std::string quoted(const std::string& name) { return "line '" + name + "'"; }

std::vector<std::string> chips() {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator("/dev")) {  // bound: files in /dev
    if (entry.path().filename().string().starts_with("gpiochip")) {
      found.push_back(entry.path().string());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// A name that is a line's, or "label:line" with the label of a chip.
bool is_called(const std::string& name, const gpiochip_info& chip, const gpio_v2_line_info& line) {
  return line.name[0] != '\0' &&
         (name == line.name || name == std::string(chip.label) + ":" + line.name);
}

/// Adds where on a chip lines of that name are.
void find_on(const std::string& chip, int file, const std::string& name,
             std::vector<LinePlace>& places) {
  gpiochip_info info{};
  if (ioctl(file, GPIO_GET_CHIPINFO_IOCTL, &info) != 0) {
    return;
  }
  for (std::uint32_t i = 0; i < info.lines; ++i) {  // bound: lines of the chip
    gpio_v2_line_info line{};
    line.offset = i;
    if (ioctl(file, GPIO_V2_GET_LINEINFO_IOCTL, &line) == 0 && is_called(name, info, line)) {
      const bool used = (line.flags & GPIO_V2_LINE_FLAG_USED) != 0U;
      places.push_back({chip, i, used, used ? std::string(line.consumer) : std::string()});
    }
  }
}

std::vector<LinePlace> find_all(const std::vector<std::string>& names) {
  std::vector<LinePlace> places;
  for (const std::string& name : names) {  // bound: names
    places.push_back(find_line(name));
    if (places.back().chip != places.front().chip) {
      throw GpioError(quoted(name) + ": on " + places.back().chip + ", but " +
                      quoted(names.front()) + " on " + places.front().chip +
                      " (remedy: use lines of one chip)");
    }
  }
  return places;
}

[[noreturn]] void refuse(const std::vector<std::string>& names,
                         const std::vector<LinePlace>& places, int error) {
  for (std::size_t i = 0; i < names.size(); ++i) {  // bound: names
    if (error == EBUSY && !places[i].user.empty()) {
      throw GpioError(quoted(names[i]) + ": in use by '" + places[i].user +
                      "' (remedy: end that program)");
    }
  }
  throw GpioError(quoted(names.front()) + ": " + places.front().chip + ": " + std::strerror(error) +
                  " (remedy: gpioinfo tells what the line can do)");
}

std::pair<int, std::vector<std::uint32_t>> request(const std::vector<std::string>& names,
                                                   const std::string& consumer, std::uint64_t flags,
                                                   std::uint32_t buffer) {
  if (names.empty() || names.size() > GPIO_V2_LINES_MAX) {
    throw GpioError("no lines, or more than 64, were asked for (remedy: name some)");
  }
  const std::vector<LinePlace> places = find_all(names);
  gpio_v2_line_request wanted{};
  std::vector<std::uint32_t> offsets;
  for (const LinePlace& place : places) {  // bound: names
    wanted.offsets[offsets.size()] = place.offset;
    offsets.push_back(place.offset);
  }
  wanted.num_lines = static_cast<std::uint32_t>(offsets.size());
  wanted.event_buffer_size = buffer;
  wanted.config.flags = flags;
  consumer.copy(wanted.consumer, sizeof(wanted.consumer) - 1);
  const FileDescriptor chip(open(places.front().chip.c_str(), O_RDWR | O_CLOEXEC));
  if (chip.get() < 0 || ioctl(chip.get(), GPIO_V2_GET_LINE_IOCTL, &wanted) != 0) {
    refuse(names, places, errno);
  }
  fcntl(wanted.fd, F_SETFL, fcntl(wanted.fd, F_GETFL) | O_NONBLOCK);
  return {wanted.fd, offsets};
}

std::uint64_t flag(bool on, std::uint64_t bits) { return on ? bits : 0U; }

std::uint64_t mask_of(std::size_t lines) {
  return lines >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << lines) - 1U;
}

}  // namespace

LinePlace find_line(const std::string& name) {
  std::vector<LinePlace> places;
  std::string forbidden;
  const std::vector<std::string> all = chips();
  for (const std::string& chip : all) {  // bound: chips
    const FileDescriptor file(open(chip.c_str(), O_RDWR | O_CLOEXEC));
    if (file.get() >= 0) {
      find_on(chip, file.get(), name, places);
    } else if (errno == EACCES || errno == EPERM) {
      forbidden = chip;
    }
  }
  if (places.size() > 1) {
    throw GpioError(quoted(name) + ": " + places[0].chip + " and " + places[1].chip +
                    " have one of that name (remedy: put the chip's label before it, "
                    "'label:" +
                    name + "'; gpiodetect lists them)");
  }
  if (!places.empty()) {
    return places.front();
  }
  if (!forbidden.empty()) {
    throw GpioError(quoted(name) + ": " + forbidden +
                    ": permission denied (remedy: join the group that owns it, or run as root)");
  }
  if (all.empty()) {
    throw GpioError(quoted(name) + ": there is no GPIO chip (remedy: load its driver)");
  }
  throw GpioError(quoted(name) + ": no chip has a line of that name (remedy: gpioinfo lists them)");
}

GpioLines::GpioLines(int file, std::vector<std::uint32_t> offsets)
    : file_(file), offsets_(std::move(offsets)) {}

GpioLines::~GpioLines() {
  if (file_ >= 0) {
    close(file_);
  }
}

GpioLines::GpioLines(GpioLines&& other) noexcept
    : file_(std::exchange(other.file_, -1)), offsets_(std::move(other.offsets_)) {}

GpioLines GpioLines::inputs(const std::vector<std::string>& names, const std::string& consumer,
                            const InputSettings& settings) {
  const std::uint64_t flags =
      GPIO_V2_LINE_FLAG_INPUT | flag(settings.active_low, GPIO_V2_LINE_FLAG_ACTIVE_LOW) |
      flag(settings.edges, GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING) |
      flag(settings.bias == Bias::kPullUp, GPIO_V2_LINE_FLAG_BIAS_PULL_UP) |
      flag(settings.bias == Bias::kPullDown, GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN);
  auto [file, offsets] =
      request(names, consumer, flags, settings.edges ? settings.edge_buffer : 0U);
  return {file, std::move(offsets)};
}

GpioLines GpioLines::outputs(const std::vector<std::string>& names, const std::string& consumer,
                             bool active_low) {
  const std::uint64_t flags =
      GPIO_V2_LINE_FLAG_OUTPUT | flag(active_low, GPIO_V2_LINE_FLAG_ACTIVE_LOW);
  auto [file, offsets] = request(names, consumer, flags, 0U);
  return {file, std::move(offsets)};
}

bool GpioLines::levels(std::uint64_t& bits) const noexcept {
  gpio_v2_line_values values{0, mask_of(offsets_.size())};
  if (ioctl(file_, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) != 0) {
    return false;
  }
  bits = values.bits;
  return true;
}

bool GpioLines::set(std::uint64_t bits) noexcept {
  gpio_v2_line_values values{bits, mask_of(offsets_.size())};
  return ioctl(file_, GPIO_V2_LINE_SET_VALUES_IOCTL, &values) == 0;
}

int GpioLines::read_edges(Edge* edges, int count) noexcept {
  std::array<gpio_v2_line_event, kEdgesAtOnce> events{};
  const auto wanted = std::min(static_cast<std::size_t>(count), events.size());
  const ssize_t size = ::read(file_, events.data(), wanted * sizeof(events[0]));
  if (size < 0) {
    return errno == EAGAIN || errno == EINTR ? 0 : -1;
  }
  const int found = static_cast<int>(static_cast<std::size_t>(size) / sizeof(events[0]));
  for (int i = 0; i < found; ++i) {  // bound: kEdgesAtOnce
    const gpio_v2_line_event& event = events[static_cast<std::size_t>(i)];
    const auto at = std::find(offsets_.begin(), offsets_.end(), event.offset) - offsets_.begin();
    edges[i] = {event.timestamp_ns, static_cast<std::uint32_t>(at),
                event.id == GPIO_V2_LINE_EVENT_RISING_EDGE, event.seqno};
  }
  return found;
}

}  // namespace tactree::hal::linux_gpio
