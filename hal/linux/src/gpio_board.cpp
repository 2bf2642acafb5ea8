// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/gpio_board.hpp"

#include <bit>

#include "gpio_chip.hpp"
#include "monotonic_time.hpp"

namespace tactree::hal::linux_gpio {
namespace {

// Bounds the cost of read() to 4096 edges (64 * kEdgesAtOnce): later ones stay in the kernel's
// queue, and are lost only if it overflows.
constexpr int kReadsPerTick = 64;

InputSettings with_edges() {
  InputSettings settings;
  settings.edges = true;
  return settings;
}

std::vector<std::string> with_brake(const std::string& enable, const std::string& brake) {
  return brake.empty() ? std::vector<std::string>{enable} : std::vector<std::string>{enable, brake};
}

core::QuadratureLevels levels_of(std::uint64_t bits, std::uint32_t axis) {
  return {((bits >> (2U * axis)) & 1U) != 0U, ((bits >> (2U * axis + 1U)) & 1U) != 0U};
}

/// With a pull-down, an open wire reads low.
InputSettings pulled_down(bool edges) {
  InputSettings settings;
  settings.bias = Bias::kPullDown;
  settings.edges = edges;
  return settings;
}

}  // namespace

GpioEncoderBank::GpioEncoderBank(const std::vector<EncoderLines>& axes, const std::string& consumer,
                                 std::uint32_t faults_max)
    : axes_(static_cast<std::uint32_t>(axes.size())),
      index_axes_(axes_with_index(axes)),
      faults_max_(faults_max),
      lines_(GpioLines::inputs(names_of(axes), consumer, with_edges())),
      decoded_(lines_.first_levels()),
      watch_(kRest_ns) {
  for (std::uint32_t i = 0; i < axes_; ++i) {  // bound: kAxes
    decoders_[i].begin(levels_of(decoded_, i));
  }
}

std::vector<std::string> GpioEncoderBank::names_of(const std::vector<EncoderLines>& axes) {
  if (axes.empty() || axes.size() > core::kAxes) {
    throw GpioError("encoders: one to three axes are required (hint: name lines a and b of each)");
  }
  std::vector<std::string> names;
  for (const EncoderLines& axis : axes) {  // bound: kAxes
    names.push_back(axis.a);
    names.push_back(axis.b);
  }
  for (const std::uint32_t axis : axes_with_index(axes)) {  // bound: kAxes
    names.push_back(axes[axis].index);
  }
  return names;
}

std::vector<std::uint32_t> GpioEncoderBank::axes_with_index(const std::vector<EncoderLines>& axes) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < axes.size(); ++i) {  // bound: kAxes
    if (!axes[i].index.empty()) {
      found.push_back(i);
    }
  }
  return found;
}

// An edge that repeats the level of its line shows that the edges in between were merged or lost.
void GpioEncoderBank::take(const Edge& edge, core::EncoderReading& reading) noexcept {
  const std::uint64_t bit = std::uint64_t{1} << edge.line;
  unseen_ += static_cast<std::uint32_t>(((decoded_ & bit) != 0U) == edge.level);
  decoded_ = edge.level ? decoded_ | bit : decoded_ & ~bit;
  watch_.take(bit);
  if (edge.line < 2U * axes_) {
    decoders_[edge.line / 2U].step(levels_of(decoded_, edge.line / 2U));
    return;
  }
  const std::uint32_t axis = index_axes_[edge.line - 2U * axes_];
  if (edge.level) {
    reading.index[axis] = true;
    reading.index_count[axis] = static_cast<std::int32_t>(decoders_[axis].count());
  }
}

// A line differs until the kernel has delivered its edge. A lost edge is never delivered.
void GpioEncoderBank::compare_levels() noexcept {
  std::uint64_t bits = 0;
  gone_ = gone_ || !lines_.levels(bits);
  const std::uint64_t lost = watch_.look(bits ^ decoded_, lines_.held(), linux_time::now_ns());
  if (lost == 0U) {
    return;
  }
  unseen_ += static_cast<std::uint32_t>(std::popcount(lost));
  decoded_ ^= lost;
  for (std::uint32_t i = 0; i < axes_; ++i) {  // bound: kAxes
    decoders_[i].step(levels_of(decoded_, i));
  }
}

bool GpioEncoderBank::is_trusted(std::uint32_t axis) const {
  return !gone_ && lost() + decoders_[axis].illegal() <= faults_max_;
}

core::EncoderReading GpioEncoderBank::read() noexcept {
  std::array<Edge, kEdgesAtOnce> edges;
  core::EncoderReading reading;
  int found = static_cast<int>(kEdgesAtOnce);
  for (int i = 0; i < kReadsPerTick && found == static_cast<int>(kEdgesAtOnce);
       ++i) {  // bound: kReadsPerTick
    found = lines_.read_edges(edges);
    gone_ = gone_ || found < 0;
    for (int k = 0; k < found; ++k) {  // bound: kEdgesAtOnce
      take(edges[static_cast<std::size_t>(k)], reading);
    }
  }
  compare_levels();
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {  // bound: kAxes
    reading.counts[i] = static_cast<std::int32_t>(decoders_[i].count());
    reading.valid[i] = i >= axes_ ? !gone_ : is_trusted(i);
  }
  return reading;
}

AmplifiersGood::AmplifiersGood(const std::string& line, const std::string& consumer) {
  if (!line.empty()) {
    line_.emplace(GpioLines::inputs({line}, consumer, pulled_down(false)));
  }
}

bool AmplifiersGood::read() const noexcept {
  std::uint64_t bits = 1;
  return !line_ || (line_->levels(bits) && bits != 0U);
}

GpioEnableLine::GpioEnableLine(const std::string& enable, const std::string& read_back,
                               const std::string& consumer, const std::string& brake)
    : enable_(GpioLines::outputs(with_brake(enable, brake), consumer, false)),
      read_back_(GpioLines::inputs({read_back}, consumer, pulled_down(false))) {}

bool GpioEnableLine::read_back() noexcept {
  std::uint64_t bits = 0;
  return read_back_.levels(bits) && bits != 0U;
}

GpioSafetyInputs::GpioSafetyInputs(const std::string& emergency_stop, const std::string& dead_man,
                                   const std::string& consumer)
    : emergency_stop_(GpioLines::inputs({emergency_stop}, consumer, pulled_down(true))),
      dead_man_(GpioLines::inputs({dead_man}, consumer, pulled_down(false))) {}

// Any edge shows that the line was low before or after it, even if edges were merged or lost.
bool GpioSafetyInputs::emergency_stop() noexcept {
  std::array<Edge, kEdgesAtOnce> edges;
  const bool changed = emergency_stop_.read_edges(edges) != 0;
  std::uint64_t bits = 0;
  return changed || !emergency_stop_.levels(bits) || bits == 0U;
}

bool GpioSafetyInputs::dead_man() noexcept {
  std::uint64_t bits = 0;
  return dead_man_.levels(bits) && bits != 0U;
}

}  // namespace tactree::hal::linux_gpio
