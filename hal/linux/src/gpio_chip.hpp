#pragma once
// Internal interface between gpio_lines.cpp and the implementations for the two generations of
// libgpiod, libgpiod_1.cpp and libgpiod_2.cpp.

#include <cstdint>
#include <string>
#include <vector>

#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {

/// Converts a string of the library; nullptr gives an empty string.
[[nodiscard]] inline std::string text_of(const char* text) {
  return text == nullptr ? std::string() : text;
}

struct ChipLine {
  std::string name;  ///< empty: the line has no name
  bool used = false;
  std::string user;
};

struct Chip {
  std::string label;
  std::vector<ChipLine> lines;
};

/// Reads names and users of the lines of a chip. Returns 0 or an errno value.
[[nodiscard]] int read_chip(const std::string& device, Chip& chip);

/// Lines of one chip, found by their names; 1 to 64.
struct WantedLines {
  std::vector<std::string> names;
  std::vector<LinePlace> places;
  std::string consumer;

  [[nodiscard]] const std::string& chip() const { return places.front().chip; }
};

constexpr std::size_t kMaxLines = 64;
constexpr std::uint64_t kRest_ns = 2'000'000;  // maximum time from an interrupt to its edge

/// Throws GpioError.
[[nodiscard]] WantedLines find_lines(const std::vector<std::string>& names,
                                     const std::string& consumer);

/// Throws GpioError for a request that the kernel refused.
[[noreturn]] void refuse(const WantedLines& wanted, int error);

}  // namespace tactree::hal::linux_gpio
