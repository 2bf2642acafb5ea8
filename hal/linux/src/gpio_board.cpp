#include "tactree/hal/linux/gpio_board.hpp"

namespace tactree::hal::linux_gpio {
namespace {

constexpr int kEdgesAtOnce = 64;
constexpr int kReadsPerTick = 64;  // 4096 edges; what comes faster than that is lost, and counted

InputSettings with_edges() {
  InputSettings settings;
  settings.edges = true;
  return settings;
}

std::vector<std::string> with_brake(const std::string& enable, const std::string& brake) {
  return brake.empty() ? std::vector<std::string>{enable} : std::vector<std::string>{enable, brake};
}

/// An open wire reads low.
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
      lines_(GpioLines::inputs(names_of(axes), consumer, with_edges())) {
  std::uint64_t bits = 0;
  gone_ = !lines_.levels(bits);
  for (std::uint32_t i = 0; i < axes_; ++i) {  // bound: kAxes
    decoders_[i].begin({((bits >> (2U * i)) & 1U) != 0U, ((bits >> (2U * i + 1U)) & 1U) != 0U});
  }
}

std::vector<std::string> GpioEncoderBank::names_of(const std::vector<EncoderLines>& axes) {
  if (axes.empty() || axes.size() > core::kAxes) {
    throw GpioError("encoders: one to three axes are wanted (remedy: name lines a and b of each)");
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

void GpioEncoderBank::take(const Edge& edge, core::EncoderReading& reading) noexcept {
  lost_ += edge.sequence - next_sequence_;
  next_sequence_ = edge.sequence + 1U;
  last_edge_ns_ = edge.time_ns;
  if (edge.line >= 2U * axes_) {
    const std::uint32_t axis = index_axes_[edge.line - 2U * axes_];
    if (edge.level) {
      reading.index[axis] = true;
      reading.index_count[axis] = static_cast<std::int32_t>(decoders_[axis].count());
    }
    return;
  }
  core::QuadratureDecoder& decoder = decoders_[edge.line / 2U];
  core::QuadratureLevels levels = decoder.levels();
  (edge.line % 2U == 0U ? levels.a : levels.b) = edge.level;
  decoder.step(levels);
}

bool GpioEncoderBank::is_trusted(std::uint32_t axis) const {
  return !gone_ && lost_ + decoders_[axis].illegal() <= faults_max_;
}

core::EncoderReading GpioEncoderBank::read() noexcept {
  std::array<Edge, kEdgesAtOnce> edges;
  core::EncoderReading reading;
  int found = kEdgesAtOnce;
  for (int i = 0; i < kReadsPerTick && found == kEdgesAtOnce; ++i) {  // bound: kReadsPerTick
    found = lines_.read_edges(edges.data(), kEdgesAtOnce);
    gone_ = gone_ || found < 0;
    for (int k = 0; k < found; ++k) {  // bound: kEdgesAtOnce
      take(edges[static_cast<std::size_t>(k)], reading);
    }
  }
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

bool GpioSafetyInputs::emergency_stop() noexcept {
  std::array<Edge, kEdgesAtOnce> edges;
  const int found = emergency_stop_.read_edges(edges.data(), kEdgesAtOnce);
  bool pressed = found < 0;
  for (int i = 0; i < found; ++i) {  // bound: kEdgesAtOnce
    pressed = pressed || !edges[static_cast<std::size_t>(i)].level;
  }
  std::uint64_t bits = 0;
  return pressed || !emergency_stop_.levels(bits) || bits == 0U;
}

bool GpioSafetyInputs::dead_man() noexcept {
  std::uint64_t bits = 0;
  return dead_man_.levels(bits) && bits != 0U;
}

}  // namespace tactree::hal::linux_gpio
