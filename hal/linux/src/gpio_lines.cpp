// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/gpio_lines.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "gpio_chip.hpp"
#include "monotonic_time.hpp"

namespace tactree::hal::linux_gpio {
namespace {

// Maximum wait for lines that do not rest. A device that moves would otherwise delay the start of
// the program indefinitely, without a message.
constexpr std::uint64_t kPatience_ns = 1'000'000'000;

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

/// Returns true if `name` is the name of the line, or "label:line" with the label of the chip.
bool is_called(const std::string& name, const Chip& chip, const ChipLine& line) {
  return !line.name.empty() && (name == line.name || name == chip.label + ":" + line.name);
}

/// Appends the lines of that name on a chip.
void find_on(const std::string& device, const Chip& chip, const std::string& name,
             std::vector<LinePlace>& places) {
  for (std::size_t i = 0; i < chip.lines.size(); ++i) {  // bound: lines of the chip
    const ChipLine& line = chip.lines[i];
    if (is_called(name, chip, line)) {
      places.push_back({device, static_cast<std::uint32_t>(i), line.used, line.user});
    }
  }
}

void sleep_ns(std::uint64_t time_ns) {
  const timespec time{static_cast<time_t>(time_ns / linux_time::kNsPerSecond),
                      static_cast<decltype(timespec::tv_nsec)>(time_ns % linux_time::kNsPerSecond)};
  (void)nanosleep(&time, nullptr);
}

}  // namespace

LinePlace find_line(const std::string& name) {
  std::vector<LinePlace> places;
  std::string forbidden;
  const std::vector<std::string> all = chips();
  for (const std::string& chip : all) {  // bound: chips
    Chip lines;
    const int error = read_chip(chip, lines);
    if (error == 0) {
      find_on(chip, lines, name, places);
    } else if (error == EACCES || error == EPERM) {
      forbidden = chip;
    }
  }
  if (places.size() > 1) {
    throw GpioError(
        quoted(name) + ": " + places[0].chip + " and " + places[1].chip +
        " have a line of that name (hint: put the chip's label before the name, 'label:" + name +
        "'; gpiodetect lists them)");
  }
  if (!places.empty()) {
    return places.front();
  }
  if (!forbidden.empty()) {
    throw GpioError(quoted(name) + ": " + forbidden +
                    ": permission denied (hint: join the group that owns it, or run as root)");
  }
  if (all.empty()) {
    throw GpioError(quoted(name) + ": there is no GPIO chip (hint: load its driver)");
  }
  throw GpioError(quoted(name) +
                  ": no chip has a line of that name (hint: use a name listed by gpioinfo)");
}

WantedLines find_lines(const std::vector<std::string>& names, const std::string& consumer) {
  if (names.empty() || names.size() > kMaxLines) {
    throw GpioError("no lines, or more than 64, were requested (hint: name 1 to 64 lines)");
  }
  WantedLines wanted{names, {}, consumer};
  for (const std::string& name : names) {  // bound: names
    wanted.places.push_back(find_line(name));
    if (wanted.places.back().chip != wanted.chip()) {
      throw GpioError(quoted(name) + ": is on " + wanted.places.back().chip + ", but " +
                      quoted(names.front()) + " is on " + wanted.chip() +
                      " (hint: use lines of one chip)");
    }
  }
  return wanted;
}

void refuse(const WantedLines& wanted, int error) {
  for (std::size_t i = 0; i < wanted.names.size(); ++i) {  // bound: names
    if (error == EBUSY && !wanted.places[i].user.empty()) {
      throw GpioError(quoted(wanted.names[i]) + ": in use by '" + wanted.places[i].user +
                      "' (hint: end that program)");
    }
  }
  throw GpioError(quoted(wanted.names.front()) + ": " + wanted.chip() + ": " +
                  std::strerror(error) + " (hint: see gpioinfo for the capabilities of the line)");
}

// The request itself may have caused edges. The levels are read at the start of the rest: at its
// end, a device that moves slowly may have changed a level before the edge is in the queue.
void GpioLines::await_rest(const std::string& name) {
  const std::uint64_t end_ns = linux_time::now_ns() + kPatience_ns;
  do {  // bound: kPatience_ns / kRest_ns
    if (linux_time::now_ns() > end_ns) {
      throw GpioError(quoted(name) +
                      ": this line, or one requested with it, changed for 1 s without a rest of 2 "
                      "ms (hint: hold the device still at the start)");
    }
    begin_edges();
    if (!levels(first_levels_)) {
      throw GpioError(quoted(name) + ": its chip was removed (hint: load its driver)");
    }
    sleep_ns(kRest_ns);
  } while (!is_at_rest());
}

}  // namespace tactree::hal::linux_gpio
