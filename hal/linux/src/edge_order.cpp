// Loop and memory annotations: docs/BOUND.md.

#include "edge_order.hpp"

#include <algorithm>

#include "gpio_chip.hpp"

namespace tactree::hal::linux_gpio {
namespace {

// Allowance for the time from the kernel's count of an interrupt to its time stamp.
constexpr std::uint64_t kStamp_ns = 10'000;

}  // namespace

void EdgeOrder::begin(const std::vector<std::uint32_t>& interrupts) {
  for (std::size_t i = 0; i < lines_.size(); ++i) {  // bound: kMaxLines
    lines_[i] = Line();
    lines_[i].base = interrupts[i];
  }
  lost_ = 0;
}

void EdgeOrder::look(std::uint64_t begin_ns, std::uint64_t end_ns,
                     const std::vector<std::uint32_t>& interrupts) {
  look_ns_ = begin_ns;
  until_ns_ = end_ns + kStamp_ns;
  for (std::size_t i = 0; i < lines_.size(); ++i) {  // bound: kMaxLines
    Line& line = lines_[i];
    line.counted = interrupts[i] - line.base;
    if (!line.checked) {
      begin_check(line);
    }
  }
}

void EdgeOrder::begin_check(Line& line) const {
  line.checked = true;
  line.due = line.counted;
  line.arrived = line.queued;
  line.since_ns = look_ns_;
  line.until_ns = until_ns_;
}

// Returns true if the edges of the check have been read from the queue, or were given up as lost.
bool EdgeOrder::end_check(Line& line) {
  const auto missing = static_cast<std::int32_t>(line.due - line.arrived);
  if (missing > 0 && look_ns_ - line.since_ns < kRest_ns) {
    return false;
  }
  const std::uint32_t lost = missing > 0 ? static_cast<std::uint32_t>(missing) : 0U;
  lost_ += lost;
  line.queued += lost;
  line.checked = false;
  line.clear_ns = line.since_ns;
  return true;
}

void EdgeOrder::add(const Edge& edge) {
  Line& line = lines_[edge.line];
  ++line.queued;
  line.arrived += edge.time_ns <= line.until_ns ? 1U : 0U;
  if (line.end - line.first == kHeld) {
    ++lost_;
    return;
  }
  line.held[line.end++ % kHeld] = edge;
}

// Each line has a separate check. A common check would never end while in each pass an edge of some
// line is in flight.
void EdgeOrder::settle() {
  certain_ns_ = look_ns_;
  for (Line& line : lines_) {  // bound: kMaxLines
    if (end_check(line) && line.clear_ns != look_ns_) {
      begin_check(line);
      (void)end_check(line);
    }
    certain_ns_ = std::min(certain_ns_, line.clear_ns);
  }
}

bool EdgeOrder::take(Edge& edge) {
  Line* oldest = nullptr;
  for (Line& line : lines_) {  // bound: kMaxLines
    const bool certain =
        line.first != line.end && line.held[line.first % kHeld].time_ns <= certain_ns_;
    if (certain && (oldest == nullptr || line.held[line.first % kHeld].time_ns <
                                             oldest->held[oldest->first % kHeld].time_ns)) {
      oldest = &line;
    }
  }
  if (oldest == nullptr) {
    return false;
  }
  edge = oldest->held[oldest->first++ % kHeld];
  return true;
}

std::uint64_t EdgeOrder::held() const {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i) {  // bound: kMaxLines
    bits |= static_cast<std::uint64_t>(lines_[i].first != lines_[i].end) << i;
  }
  return bits;
}

}  // namespace tactree::hal::linux_gpio
