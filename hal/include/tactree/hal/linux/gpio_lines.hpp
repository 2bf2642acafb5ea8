#pragma once
// Lines of a Linux computer's GPIO chips, by their names, through the kernel's own interface
// (version 2, since 5.10; <linux/gpio.h>): it has everything that is needed here - edges in their
// order over several lines, with time and sequence number - in one form, where libgpiod has two.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactree::hal::linux_gpio {

/// "line 'encoder0-a': cause (remedy: ...)"
class GpioError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Edge {
  std::uint64_t time_ns = 0;   ///< CLOCK_MONOTONIC, of the interrupt
  std::uint32_t line = 0;      ///< index in the request
  bool level = false;          ///< from now on
  std::uint32_t sequence = 0;  ///< 1, 2, ... over all lines: a gap is edges that were lost
};

/// Where a line is.
struct LinePlace {
  std::string chip;  ///< its device: "/dev/gpiochip0"
  std::uint32_t offset = 0;
  bool used = false;
  std::string user;  ///< who has it, as far as that is told
};

/// Looks a line up without taking it. `name` is the line's, or where several chips have one of that
/// name, the chip's label, a colon, and the line's: "pinctrl-rp1:GPIO17". Throws GpioError.
[[nodiscard]] LinePlace find_line(const std::string& name);

enum class Bias : std::uint8_t { kAsIs, kPullUp, kPullDown };

struct InputSettings {
  bool active_low = false;
  bool edges = false;  ///< of both directions are told
  Bias bias = Bias::kAsIs;
  std::uint32_t edge_buffer = 1024;  ///< edges the kernel keeps until they are read
};

/// Lines of one chip, requested together: nobody else has them as long as this object lives.
class GpioLines {
 public:
  /// `consumer`: what gpioinfo shows. Throws GpioError: no such line, in use by whom, several of
  /// that name, on different chips, no permission.
  static GpioLines inputs(const std::vector<std::string>& names, const std::string& consumer,
                          const InputSettings& settings);
  /// Off to begin with.
  static GpioLines outputs(const std::vector<std::string>& names, const std::string& consumer,
                           bool active_low);

  ~GpioLines();
  GpioLines(GpioLines&& other) noexcept;
  GpioLines& operator=(GpioLines&&) = delete;
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  /// Levels of all lines at one moment: bit n is line n. False: the chip is gone.
  [[nodiscard]] bool levels(std::uint64_t& bits) const noexcept;
  [[nodiscard]] bool set(std::uint64_t bits) noexcept;
  /// Edges since the last call, oldest first, at most as many as fit; never waits. Returns how
  /// many, or -1: the chip is gone.
  [[nodiscard]] int read_edges(Edge* edges, int count) noexcept;
  [[nodiscard]] int descriptor() const { return file_; }

 private:
  GpioLines(int file, std::vector<std::uint32_t> offsets);

  int file_ = -1;
  std::vector<std::uint32_t> offsets_;
};

}  // namespace tactree::hal::linux_gpio
