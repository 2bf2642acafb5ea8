#include "tactree/core/configuration/parameters.hpp"

#include <cstddef>

namespace tactree::core {
namespace {

// Location of a parameter in a Configuration. All parameters are float32, except the home counts,
// which are int32.
struct Place {
  Parameter parameter{};
  std::size_t offset = 0;
  bool is_count = false;
};

constexpr std::size_t kFloat = sizeof(float);
constexpr float kMaxCounts = 16777216.0F;  // 2^24: float32 represents all integers up to it

#define TACTREE_AXES(member, low, high, is_count)                                         \
  {{#member "[0]", low, high}, offsetof(Configuration, member), is_count},                \
      {{#member "[1]", low, high}, offsetof(Configuration, member) + kFloat, is_count}, { \
    {#member "[2]", low, high}, offsetof(Configuration, member) + 2 * kFloat, is_count    \
  }
#define TACTREE_ONE(member, low, high) \
  { {#member, low, high}, offsetof(Configuration, member), false }

constexpr Place kPlaces[kParameters] = {
    TACTREE_AXES(device.home_count, -kMaxCounts, kMaxCounts, true),
    TACTREE_AXES(device.home_position, -100.0F, 100.0F, false),
    TACTREE_AXES(device.counts_per_m, 1.0F, 1e9F, false),
    TACTREE_AXES(device.counts_per_revolution, 1.0F, 1e7F, false),
    TACTREE_AXES(device.ratio, -1e5F, 1e5F, false),
    TACTREE_AXES(motors.effort_max, 1e-4F, 1000.0F, false),
    TACTREE_ONE(device.tip_mass_kg, 0.0F, 100.0F),
    TACTREE_ONE(device.paddle_m, 0.001F, 10.0F),
    TACTREE_ONE(model_origin_m.x, -10.0F, 10.0F),
    TACTREE_ONE(model_origin_m.y, -10.0F, 10.0F),
    TACTREE_ONE(model_origin_m.z, -10.0F, 10.0F),
    TACTREE_ONE(velocity_cutoff_hz, 1.0F, 10000.0F),
    TACTREE_ONE(passivity_Ns_m, 0.0F, 100.0F),
    TACTREE_ONE(device_damping_Ns_m, 0.0F, 1000.0F),
    TACTREE_ONE(hand_damping_Ns_m, 0.0F, 1000.0F),
    TACTREE_ONE(delay_s, 0.0F, 0.1F),
    TACTREE_ONE(motors.continuous_share, 0.05F, 1.0F),
    TACTREE_ONE(motors.thermal_time_s, 1.0F, 1000.0F),
};

#undef TACTREE_AXES
#undef TACTREE_ONE

}  // namespace

Parameter parameter(std::uint32_t number) { return kPlaces[number].parameter; }

float parameter_of(const Configuration& configuration, std::uint32_t number) {
  const Place& place = kPlaces[number];
  const auto* const at = reinterpret_cast<const std::byte*>(&configuration) + place.offset;
  if (place.is_count) {
    std::int32_t count = 0;
    __builtin_memcpy(&count, at, sizeof count);
    return static_cast<float>(count);
  }
  float value = 0.0F;
  __builtin_memcpy(&value, at, sizeof value);
  return value;
}

bool set_parameter(Configuration& configuration, std::uint32_t number, float value) {
  const Place& place = kPlaces[number];
  if (!(value >= place.parameter.min && value <= place.parameter.max)) {
    return false;
  }
  auto* const at = reinterpret_cast<std::byte*>(&configuration) + place.offset;
  if (place.is_count) {
    const auto count = static_cast<std::int32_t>(value);
    __builtin_memcpy(at, &count, sizeof count);
  } else {
    __builtin_memcpy(at, &value, sizeof value);
  }
  return true;
}

}  // namespace tactree::core
