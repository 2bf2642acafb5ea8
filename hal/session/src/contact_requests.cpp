#include "tactree/session/contact_requests.hpp"

#include "tactree/session/request_filter.hpp"

namespace tactree::session {

using core::wire::WireStatus;

namespace {

core::Vec3 vector(const float* components) { return {components[0], components[1], components[2]}; }

}  // namespace

WireStatus limits_of(std::span<const std::byte> payload, const core::Controller& controller,
                     const core::Configuration& base, core::Adjustment& adjustment) {
  core::wire::SetLimitsRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  // Written so that NaN is refused.
  if (!(request.force_max_N <= base.limits.force_max_N) ||
      !(request.slew_N_s <= base.limits.slew_N_s)) {
    return WireStatus::kBadValue;
  }
  adjustment = controller.adjustment();
  adjustment.limits.force_max_N = request.force_max_N;
  adjustment.limits.slew_N_s = request.slew_N_s;
  adjustment.limits.ramp_s = request.ramp_s;
  return WireStatus::kOk;
}

WireStatus material_of(std::span<const std::byte> payload, const core::Controller& controller,
                       core::Adjustment& adjustment) {
  core::wire::SetMaterialRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  adjustment = controller.adjustment();
  adjustment.contact.stiffness_N_m = request.stiffness_N_m;
  adjustment.contact.damping_Ns_m = request.damping_Ns_m;
  adjustment.contact.static_friction = request.static_friction;
  adjustment.contact.dynamic_friction = request.dynamic_friction;
  adjustment.use_materials = request.use_materials != 0U;
  return WireStatus::kOk;
}

WireStatus texture_of(std::span<const std::byte> payload, const core::Controller& controller,
                      core::Adjustment& adjustment) {
  core::wire::SetTextureRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  adjustment = controller.adjustment();
  adjustment.contact.texture_height_m = request.height_m;
  adjustment.contact.texture_wavelength_m = request.wavelength_m;
  return WireStatus::kOk;
}

Outcome move_body(std::span<const std::byte> payload, const core::Controller& controller,
                  TickMailbox& mailbox, Reply& reply) {
  core::wire::MoveBodyRequest r;
  if (!core::wire::decode_message(payload, r)) {
    reply.set_status(WireStatus::kBadLength);
    return Outcome::kAnswer;
  }
  const hal::BodyUpdate update{
      r.body,
      r.enabled != 0U,
      {{r.rotation_wxyz[0], vector(&r.rotation_wxyz[1])}, vector(r.translation_m)},
      {vector(r.linear_m_s), vector(r.angular_rad_s)}};
  if (r.body >= core::kMaxBodies || !controller.has_body(r.body) || !core::is_valid(update.pose) ||
      !core::is_valid(update.motion)) {
    reply.set_status(WireStatus::kBadValue);
    return Outcome::kAnswer;
  }
  return mailbox.post_body(update) ? Outcome::kAnswer : Outcome::kLater;
}

WireStatus add_force(std::span<const std::byte> payload, const core::Controller& controller,
                     TickMailbox& mailbox) {
  core::wire::AddForceRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  const core::Vec3 force = vector(request.force_N);
  constexpr auto kMaxDurationMs = static_cast<std::uint32_t>(1e3F * core::kAddedForceSeconds);
  if (!core::is_finite(force) || request.duration_ms == 0U ||
      request.duration_ms > kMaxDurationMs) {
    return WireStatus::kBadValue;
  }
  if (controller.state() != core::State::kActive) {
    return WireStatus::kNotNow;
  }
  const float ticks =
      1e-3F * static_cast<float>(request.duration_ms) * controller.configuration().rate_hz;
  mailbox.post_force({force, static_cast<std::uint32_t>(ticks < 1.0F ? 1.0F : ticks)});
  return WireStatus::kOk;
}

}  // namespace tactree::session
