// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/control/flight_recorder.hpp"

#include <limits>

namespace tactree::core {
namespace {

// Rounds and saturates. NaN gives the maximum value.
template <class T>
T rounded(float value) {
  constexpr auto kMax = static_cast<float>(std::numeric_limits<T>::max());
  const float inside = value < kMax ? (value > -kMax ? value : -kMax) : kMax;
  return static_cast<T>(inside + (inside < 0.0F ? -0.5F : 0.5F));
}

template <class T>
void put(Vec3 v, float scale, T (&to)[3]) {
  to[0] = rounded<T>(scale * v.x);
  to[1] = rounded<T>(scale * v.y);
  to[2] = rounded<T>(scale * v.z);
}

}  // namespace

void FlightRecorder::add(const Moment& moment) {
  if (moment.faults == 0U) {
    snapshot_.faults = 0;
    left_ = kAfterFault;
  } else if (snapshot_.faults == 0U) {
    snapshot_ = {moment.faults,          moment.tick,     moment.probe,
                 moment.rendering.proxy, moment.velocity, last_force_};
  }
  last_force_ = moment.force;
  if (left_ == 0U) {
    return;
  }
  left_ -= moment.faults != 0U ? 1U : 0U;
  FlightRecord& record = records_[next_];
  put(moment.probe, FlightRecord::kMetre, record.probe);
  put(moment.rendering.proxy - moment.probe, FlightRecord::kDepth, record.proxy);
  put(moment.force, FlightRecord::kNewton, record.force);
  record.state = static_cast<std::uint8_t>(static_cast<std::uint32_t>(moment.state) |
                                           (moment.rendering.in_contact ? 8U : 0U) |
                                           (moment.rendering.slipping ? 16U : 0U));
  record.load =
      moment.load < 255.0F / 128.0F ? static_cast<std::uint8_t>(128.0F * moment.load) : 255U;
  next_ = (next_ + 1U) % kTicks;
  count_ += count_ < kTicks ? 1U : 0U;
  last_tick_ = moment.tick;
}

}  // namespace tactree::core
