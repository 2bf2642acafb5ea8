#pragma once
// Edges from one queue for each line, in one order over all lines. The queues carry no numbers: an
// edge that the kernel dropped or merged is detected by the number of interrupts of its line, which
// the kernel counts as well.
//
// An edge is in flight from its interrupt until a thread of the kernel has put it into the queue.
// While one is in flight, the order of later edges of other lines is unknown: these are held back.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {

class EdgeOrder {
 public:
  /// Edges of a line that wait for their turn.
  static constexpr std::uint32_t kHeld = 64;

  explicit EdgeOrder(std::size_t lines) : lines_(lines) {}

  /// Starts, with empty queues. `interrupts`: number of each line so far; one element for each
  /// line.
  void begin(const std::vector<std::uint32_t>& interrupts);

  /// Start of a look at all queues. The interrupts were read between `begin_ns` and `end_ns`,
  /// before any queue is read; CLOCK_MONOTONIC.
  void look(std::uint64_t begin_ns, std::uint64_t end_ns,
            const std::vector<std::uint32_t>& interrupts);
  /// An edge of a queue, oldest first.
  void add(const Edge& edge);
  /// The queue of a line was full: edges may have been dropped.
  void overflowed() { ++lost_; }
  /// End of a look. Cost: linear in the lines.
  void settle();

  /// Removes the oldest edge whose order is certain. False: there is none. Cost: linear in the
  /// lines.
  [[nodiscard]] bool take(Edge& edge);
  [[nodiscard]] std::uint32_t lost() const { return lost_; }
  /// Lines with edges that wait for their turn: bit n is line n.
  [[nodiscard]] std::uint64_t held() const;

 private:
  struct Line {
    std::array<Edge, kHeld> held;
    std::uint32_t first = 0;     // edges taken so far
    std::uint32_t end = 0;       // edges held so far
    std::uint32_t queued = 0;    // edges that came out of the queue, and those given up
    std::uint32_t base = 0;      // interrupts at begin()
    std::uint32_t counted = 0;   // interrupts from begin() to the last look
    std::uint64_t clear_ns = 0;  // all edges up to this time have come out of the queue
    // A check: of the edges up to `until_ns`, `due` must come out of the queue.
    bool checked = false;
    std::uint32_t due = 0;
    std::uint32_t arrived = 0;
    std::uint64_t since_ns = 0;
    std::uint64_t until_ns = 0;
  };

  void begin_check(Line& line) const;
  [[nodiscard]] bool end_check(Line& line);

  std::vector<Line> lines_;
  std::uint64_t look_ns_ = 0;
  std::uint64_t until_ns_ = 0;    // of the checks that begin with this look
  std::uint64_t certain_ns_ = 0;  // all edges of all lines up to this time have come out
  std::uint32_t lost_ = 0;
};

}  // namespace tactree::hal::linux_gpio
