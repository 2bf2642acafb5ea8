#pragma once
// Merges the edges of one queue per line into chronological order over all lines. The edges have no
// sequence numbers: edges that the kernel dropped or merged are detected by the interrupt count of
// their line, which the kernel provides as well.
//
// An edge is in flight from its interrupt until a kernel thread has put it into the queue. While an
// edge is in flight, the order of later edges of other lines is uncertain, so these are held back.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {

class EdgeOrder {
 public:
  /// Maximum number of edges of a line that are held back; more are lost. They wait for up to
  /// kRest_ns, 2 ms: 54 edges at 27 000 per second, which an axis reaches (docs/FIGURES.md).
  static constexpr std::uint32_t kHeld = 64;

  explicit EdgeOrder(std::size_t lines) : lines_(lines) {}

  /// Starts with empty queues. `interrupts`: interrupt count of each line.
  void begin(const std::vector<std::uint32_t>& interrupts);

  /// Begins a pass over all queues. The interrupt counts were read between `begin_ns` and `end_ns`
  /// (CLOCK_MONOTONIC), before any queue is read.
  void look(std::uint64_t begin_ns, std::uint64_t end_ns,
            const std::vector<std::uint32_t>& interrupts);
  /// Adds an edge of a queue, oldest first.
  void add(const Edge& edge);
  /// Call if the queue of a line was full: edges may have been dropped.
  void overflowed() { ++lost_; }
  /// Ends the pass. Cost: linear in the number of lines.
  void settle();

  /// Removes the oldest edge whose order is certain. Returns false if there is none. Cost: linear
  /// in the number of lines.
  [[nodiscard]] bool take(Edge& edge);
  [[nodiscard]] std::uint32_t lost() const { return lost_; }
  /// Lines with edges that are held back: bit n is line n.
  [[nodiscard]] std::uint64_t held() const;

 private:
  struct Line {
    std::array<Edge, kHeld> held;
    std::uint32_t first = 0;     // edges taken so far
    std::uint32_t end = 0;       // edges put into `held` so far
    std::uint32_t queued = 0;    // edges read from the queue, and those given up as lost
    std::uint32_t base = 0;      // interrupts at begin()
    std::uint32_t counted = 0;   // interrupts from begin() to the last look()
    std::uint64_t clear_ns = 0;  // all edges up to this time have been read
    // A check waits until `due` edges up to `until_ns` have been read from the queue.
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
  std::uint64_t until_ns_ = 0;    // of the checks that begin in this pass
  std::uint64_t certain_ns_ = 0;  // all edges of all lines up to this time have been read
  std::uint32_t lost_ = 0;
};

}  // namespace tactree::hal::linux_gpio
