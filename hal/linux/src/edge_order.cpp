// Loop and memory annotations: docs/BOUND.md.

#include "edge_order.hpp"

#include <algorithm>

#include "gpio_chip.hpp"

namespace tactree::hal::linux_gpio {
namespace {

// The kernel counts an interrupt before it takes the time.
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
  for (std::size_t i = 0; i < lines_.size(); ++i) {  // bound: kMaxLines
    Line& line = lines_[i];
    if (!line.checked) {
      line.checked = true;
      line.due = interrupts[i] - line.base;
      line.arrived = line.queued;
      line.since_ns = begin_ns;
      line.until_ns = end_ns + kStamp_ns;
    }
  }
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

void EdgeOrder::settle() {
  bool complete = true;
  std::uint64_t checked_ns = look_ns_;
  for (Line& line : lines_) {  // bound: kMaxLines
    const auto missing = static_cast<std::int32_t>(line.due - line.arrived);
    if (missing > 0 && look_ns_ - line.since_ns < kRest_ns) {
      complete = false;
      continue;
    }
    const std::uint32_t lost = missing > 0 ? static_cast<std::uint32_t>(missing) : 0U;
    lost_ += lost;
    line.queued += lost;
    line.checked = false;
    checked_ns = std::min(checked_ns, line.since_ns);
  }
  certain_ns_ = complete ? checked_ns : certain_ns_;
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

}  // namespace tactree::hal::linux_gpio
