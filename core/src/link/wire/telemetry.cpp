// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/link/wire/telemetry.hpp"

namespace tactree::core::wire {
namespace {

// Telemetry has the layout of the wire, so a field is a range of its bytes.
constexpr bool sizes_add_up() {
  std::size_t all = sizeof(TelemetryHeader);
  for (const std::uint32_t bytes : kTelemetryFieldBytes) {  // bound: kTelemetryFields
    all += bytes;
  }
  return all == sizeof(Telemetry);
}
static_assert(sizes_add_up());
static_assert(offsetof(Telemetry, state) == 16 && offsetof(Telemetry, probe_m) == 28 &&
              offsetof(Telemetry, velocity_m_s) == 40 && offsetof(Telemetry, force_N) == 52 &&
              offsetof(Telemetry, proxy_m) == 64 && offsetof(Telemetry, normal) == 76 &&
              offsetof(Telemetry, penetration_m) == 88 && offsetof(Telemetry, wanted_N) == 100 &&
              offsetof(Telemetry, overruns) == 112 && offsetof(Telemetry, reactions) == 120 &&
              offsetof(Telemetry, gravity_N) == 176);

void copy(Vec3 from, float (&to)[3]) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

/// Calls `take(offset in Telemetry, bytes)` for each field, until it returns false.
template <class Take>
bool for_each_field(std::uint32_t fields, Take take) {
  std::size_t offset = sizeof(TelemetryHeader);
  for (std::uint32_t i = 0; i < kTelemetryFields; ++i) {  // bound: kTelemetryFields
    const std::size_t bytes = kTelemetryFieldBytes[i];
    if ((fields & (1U << i)) != 0U && !take(offset, bytes)) {
      return false;
    }
    offset += bytes;
  }
  return true;
}

}  // namespace

Telemetry to_telemetry(const TelemetryHeader& header, const Status& status) {
  const Rendering& rendering = status.rendering;
  Telemetry t;
  t.header = header;
  t.state = static_cast<std::uint32_t>(status.state);
  t.faults = status.faults;
  t.limits = status.limits;
  copy(status.probe, t.probe_m);
  copy(status.velocity, t.velocity_m_s);
  copy(status.force, t.force_N);
  copy(rendering.proxy, t.proxy_m);
  copy(rendering.normal, t.normal);
  if (rendering.in_contact) {
    t.penetration_m = rendering.penetration_m;
    t.body = rendering.body;
    t.strength = rendering.strength;
  }
  copy(rendering.force, t.wanted_N);
  t.overruns = status.overruns;
  t.load = status.load;
  static_assert(sizeof t.reactions / sizeof t.reactions[0] == kMaxReachableBodies);
  for (std::uint32_t i = 0; i < kMaxReachableBodies; ++i) {  // bound: kMaxReachableBodies
    t.reactions[i].body = status.reactions[i].body;
    copy(status.reactions[i].force_N, t.reactions[i].force_N);
    copy(status.reactions[i].torque_Nm, t.reactions[i].torque_Nm);
  }
  copy(status.gravity_force, t.gravity_N);
  copy(status.added_force, t.added_N);
  copy(status.motor_force, t.motors_N);
  return t;
}

std::size_t encode_telemetry(const Telemetry& telemetry, std::span<std::byte, kMaxTelemetry> out) {
  const auto from = std::as_bytes(std::span(&telemetry, 1));
  __builtin_memcpy(out.data(), from.data(), sizeof telemetry.header);
  std::size_t size = sizeof telemetry.header;
  (void)for_each_field(telemetry.header.fields, [&](std::size_t offset, std::size_t bytes) {
    __builtin_memcpy(out.data() + size, from.data() + offset, bytes);
    size += bytes;
    return true;
  });
  return size;
}

bool decode_telemetry(std::span<const std::byte> payload, Telemetry& telemetry) {
  const auto to = std::as_writable_bytes(std::span(&telemetry, 1));
  if (payload.size() < sizeof telemetry.header) {
    return false;
  }
  __builtin_memcpy(to.data(), payload.data(), sizeof telemetry.header);
  std::size_t at = sizeof telemetry.header;
  return for_each_field(telemetry.header.fields, [&](std::size_t offset, std::size_t bytes) {
    if (payload.size() - at < bytes) {
      return false;
    }
    __builtin_memcpy(to.data() + offset, payload.data() + at, bytes);
    at += bytes;
    return true;
  });
}

}  // namespace tactree::core::wire
