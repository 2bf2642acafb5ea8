#pragma once
// A tick's status as the fields of a telemetry message that were asked for.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/controller.hpp"
#include "tactree/hal/session/reply.hpp"

namespace tactree::hal {

inline constexpr std::uint32_t kAllTelemetry = (1U << core::wire::kTelemetryFields) - 1U;

namespace telemetry {

using Field = core::wire::TelemetryField;

inline void put(Reply& out, core::Vec3 v) {
  const float components[3] = {v.x, v.y, v.z};
  out.append(std::as_bytes(std::span(components)));
}

inline void put(Reply& out, std::uint32_t word) { out.append(std::as_bytes(std::span(&word, 1))); }
inline void put(Reply& out, float value) { out.append(std::as_bytes(std::span(&value, 1))); }

inline void put_state(Reply& out, const core::Status& s) {
  put(out, static_cast<std::uint32_t>(s.state));
  put(out, s.faults);
  put(out, s.limits);
}

inline void put_contact(Reply& out, const core::Status& s) {
  put(out, s.rendering.in_contact ? s.rendering.penetration_m : 0.0F);
  put(out, s.rendering.in_contact ? s.rendering.body : core::kNoBody);
  put(out, s.rendering.in_contact ? s.rendering.strength : 0.0F);
}

inline void put_timing(Reply& out, const core::Status& s) {
  put(out, s.overruns);
  put(out, s.load);
}

inline void put_reactions(Reply& out, const core::Status& s) {
  for (const core::Reaction& reaction : s.reactions) {  // bound: kMaxReachableBodies
    put(out, reaction.body);
    put(out, reaction.force_N);
    put(out, reaction.torque_Nm);
  }
}

inline void put_field(Reply& out, Field field, const core::Status& s) {
  switch (field) {
    case Field::kState:
      return put_state(out, s);
    case Field::kProbe:
      return put(out, s.probe);
    case Field::kVelocity:
      return put(out, s.velocity);
    case Field::kForce:
      return put(out, s.force);
    case Field::kProxy:
      return put(out, s.rendering.proxy);
    case Field::kNormal:
      return put(out, s.rendering.normal);
    case Field::kContact:
      return put_contact(out, s);
    case Field::kWanted:
      return put(out, s.rendering.force);
    case Field::kTiming:
      return put_timing(out, s);
    case Field::kReactions:
      return put_reactions(out, s);
  }
}

}  // namespace telemetry

/// Precondition: `header.fields` is within kAllTelemetry.
inline void put_telemetry(Reply& out, const core::wire::TelemetryHeader& header,
                          const core::Status& status) {
  out.put(header);
  for (std::uint32_t i = 0; i < core::wire::kTelemetryFields; ++i) {  // bound: kTelemetryFields
    if ((header.fields & (1U << i)) != 0U) {
      telemetry::put_field(out, static_cast<telemetry::Field>(1U << i), status);
    }
  }
}

}  // namespace tactree::hal
