#pragma once
// The functions of libgpiod that differ between its generations: libgpiod_1.cpp or libgpiod_2.cpp
// implements them, and the members of GpioLines.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {

/// A text of the library; empty for null.
[[nodiscard]] inline std::string text_of(const char* text) {
  return text == nullptr ? std::string() : text;
}

struct ChipLine {
  std::string name;  ///< empty: it has none
  bool used = false;
  std::string user;
};

struct Chip {
  std::string label;
  std::vector<ChipLine> lines;
};

/// Reads names and users of the lines of a chip. Returns 0, or an errno.
[[nodiscard]] int read_chip(const std::string& device, Chip& chip);

/// Lines of one chip, found by their names; 1 to 64.
struct WantedLines {
  std::vector<std::string> names;
  std::vector<LinePlace> places;
  std::string consumer;

  [[nodiscard]] const std::string& chip() const { return places.front().chip; }
};

constexpr std::size_t kMaxLines = 64;
constexpr std::uint64_t kRest_ns = 2'000'000;  // longest time from an interrupt to its edge

/// Throws GpioError.
[[nodiscard]] WantedLines find_lines(const std::vector<std::string>& names,
                                     const std::string& consumer);

/// Throws GpioError for a request that the kernel refused.
[[noreturn]] void refuse(const WantedLines& wanted, int error);

}  // namespace tactree::hal::linux_gpio
