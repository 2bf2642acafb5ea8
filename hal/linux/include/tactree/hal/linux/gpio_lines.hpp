#pragma once
// Access to GPIO lines of a Linux computer by name, through libgpiod 1.6 or 2.x. The build selects
// the generation that pkg-config finds. Both report the edges of several lines in chronological
// order, and count the edges that the kernel dropped or merged.

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactree::hal::linux_gpio {

/// Message: "line 'encoder0-a': cause (hint: ...)"
class GpioError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Edge {
  std::uint64_t time_ns = 0;  ///< time of the interrupt, CLOCK_MONOTONIC
  std::uint32_t line = 0;     ///< index in the request
  bool level = false;         ///< level after the edge
};

/// Position of a line.
struct LinePlace {
  std::string chip;  ///< device file, e.g. "/dev/gpiochip0"
  std::uint32_t offset = 0;
  bool used = false;
  std::string user;  ///< consumer; empty: not in use
};

/// Name and version of the library in use, e.g. "libgpiod 2.1.3".
[[nodiscard]] std::string gpio_library();

/// Finds a line without requesting it. `name`: name of the line, or "label:name" with the label of
/// its chip if several chips have a line of that name: "pinctrl-rp1:GPIO17". Throws GpioError.
[[nodiscard]] LinePlace find_line(const std::string& name);

enum class Bias : std::uint8_t { kAsIs, kPullUp, kPullDown };

/// Maximum number of edges per call of GpioLines::read_edges(): four full queues of libgpiod 1.6,
/// so that one call per tick empties those of two encoders.
constexpr std::size_t kEdgesAtOnce = 64;

struct InputSettings {
  bool active_low = false;
  bool edges = false;  ///< report rising and falling edges
  Bias bias = Bias::kAsIs;
  /// Capacity of the kernel's edge queue, at most 1024. Ignored by libgpiod 1.6, which always has a
  /// queue of 16 edges per line.
  std::uint32_t edge_buffer = 1024;
};

/// Lines of one chip, requested together. No other program can use them during the lifetime of this
/// object. For one thread.
class GpioLines {
 public:
  /// `consumer`: name shown by gpioinfo. With edges, returns after 2 ms without a change of the
  /// lines. Throws GpioError if a line is missing, in use, ambiguous, on another chip or not
  /// permitted, or if the lines are not at rest within 1 s.
  static GpioLines inputs(const std::vector<std::string>& names, const std::string& consumer,
                          const InputSettings& settings);
  /// Outputs, initially off.
  static GpioLines outputs(const std::vector<std::string>& names, const std::string& consumer,
                           bool active_low);

  ~GpioLines();
  GpioLines(GpioLines&& other) noexcept;
  GpioLines& operator=(GpioLines&&) = delete;
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  /// Reads all lines: bit n is line n. Returns false if the chip was removed. Cost: one system
  /// call; with libgpiod 1.6 and edges, one per line.
  [[nodiscard]] bool levels(std::uint64_t& bits) const noexcept;
  /// Levels before the first edge that read_edges() returns. Only for lines with edges.
  [[nodiscard]] std::uint64_t first_levels() const { return first_levels_; }
  [[nodiscard]] bool set(std::uint64_t bits) noexcept;
  /// Reads edges, oldest first over all lines; never blocks. Returns their number; a number below
  /// kEdgesAtOnce means that there are no more, -1 that the chip was removed. An edge whose order
  /// is uncertain is left for a later call, usually the next one, for at most 4 ms. Cost: one
  /// system call; with libgpiod 1.6, two per line.
  [[nodiscard]] int read_edges(std::array<Edge, kEdgesAtOnce>& edges) noexcept;
  /// Lines with edges that read_edges() has not returned because their order is uncertain: bit n is
  /// line n. Their levels may be newer than the edges returned so far.
  [[nodiscard]] std::uint64_t held() const;
  /// Number of edges that the kernel is known to have dropped or merged since the lines were
  /// requested. Edges that the chip merged before the kernel registered them are not included.
  [[nodiscard]] std::uint32_t lost() const;

 private:
  struct Request;
  explicit GpioLines(std::unique_ptr<Request> request);
  void await_rest(const std::string& name);
  void begin_edges() noexcept;
  [[nodiscard]] bool is_at_rest() noexcept;

  std::unique_ptr<Request> request_;
  std::uint64_t first_levels_ = 0;
};

}  // namespace tactree::hal::linux_gpio
