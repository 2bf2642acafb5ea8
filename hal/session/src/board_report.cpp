// Loop and memory annotations: docs/BOUND.md.

#include "tactree/session/board_report.hpp"

#include "fields.hpp"
#include "tactree/core/configuration/parameters.hpp"

namespace tactree::session {
namespace {

std::uint32_t board_flags(const core::Controller& controller, const StoreFacts& store) {
  using core::wire::BoardFlag;
  const core::Configuration& c = controller.configuration();
  const auto flag = [](bool on, BoardFlag bit) {
    return on ? static_cast<std::uint32_t>(bit) : 0U;
  };
  return flag(store.signature_required, BoardFlag::kSignatureRequired) |
         flag(c.supervision.dead_man_required, BoardFlag::kDeadManRequired) |
         flag(c.link.required, BoardFlag::kLinkRequired) |
         flag(controller.homed(), BoardFlag::kHomed) |
         flag(controller.work_is_reduced(), BoardFlag::kWorkReduced) |
         flag(!c.link.may_command, BoardFlag::kWatchOnly);
}

}  // namespace

void put_identity(const BoardIdentity& identity, Reply& reply) {
  core::wire::IdentifyReply message;
  copy(identity.board, message.board);
  copy(identity.firmware, message.firmware);
  for (std::uint32_t i = 0; i < 3U; ++i) {  // bound: 3
    message.serial[i] = identity.serial[i];
  }
  reply.put(message);
}

void put_start(const hal::StartResult& start, const hal::StartReport& report, Reply& reply) {
  const hal::CapturedFault& fault = report.last_fault;
  core::wire::ReadStartReply message;
  message.configuration = static_cast<std::uint8_t>(start.configuration);
  message.blob = static_cast<std::uint8_t>(start.blob);
  message.model = static_cast<std::uint8_t>(start.model);
  message.image = static_cast<std::uint8_t>(start.image);
  message.missing = report.missing;
  message.by_watchdog = report.by_watchdog ? 1U : 0U;
  message.fault_cause = fault.cause;
  message.fault_status = fault.status;
  message.fault_address = fault.address;
  message.fault_pc = fault.pc;
  message.fault_lr = fault.lr;
  message.fault_sp = fault.sp;
  for (std::uint32_t i = 0; i < 13U; ++i) {  // bound: 13
    message.fault_registers[i] = fault.registers[i];
  }
  reply.put(message);
}

void put_capabilities(const core::Controller& controller, const core::Configuration& base,
                      const StoreFacts& store, std::uint32_t cycles_per_second, Reply& reply) {
  const core::Configuration& c = controller.configuration();
  core::wire::CapabilitiesReply message;
  message.rate_hz = c.rate_hz;
  message.force_max_N = c.limits.force_max_N;
  message.force_limit_N = base.limits.force_max_N;
  message.slew_N_s = c.limits.slew_N_s;
  message.slew_limit_N_s = base.limits.slew_N_s;
  message.host_force_max_N = core::kAddedForceShare * c.limits.force_max_N;
  message.stiffness_N_m = c.contact.stiffness_N_m;
  message.stiffness_limit_N_m = core::stability_limit(c).with_hand_N_m;
  message.bodies_max = core::kMaxBodies;
  for (std::uint32_t i = 0; i < core::kMaxBodies; ++i) {  // bound: kMaxBodies
    message.bodies |= controller.has_body(i) ? 1U << i : 0U;
  }
  message.slots = store.slots;
  message.slot_bytes = store.slot_bytes;
  message.flags = board_flags(controller, store);
  message.trace_ticks = core::FlightRecorder::kTicks;
  message.parameters = core::kParameters;
  message.cycles_per_tick = static_cast<std::uint32_t>(static_cast<float>(cycles_per_second) /
                                                       (c.rate_hz > 0.0F ? c.rate_hz : 1.0F));
  reply.put(message);
}

void put_state(const core::Status& status, const hal::StartResult& start, std::uint32_t now_us,
               Reply& reply) {
  core::wire::StateReply message;
  message.tick = status.tick;
  message.state = static_cast<std::uint8_t>(status.state);
  message.configuration = static_cast<std::uint8_t>(start.configuration);
  message.blob = static_cast<std::uint8_t>(start.blob);
  message.model = static_cast<std::uint8_t>(start.model);
  message.faults = status.faults;
  message.limits = status.limits;
  message.overruns = status.overruns;
  message.board_time_us = now_us;
  copy(status.probe, message.probe_m);
  copy(status.force, message.force_N);
  reply.put(message);
}

bool link_age(std::uint32_t age_us, float rate_hz, std::uint16_t& ticks) {
  // The sum is truncated: 2.999 rounds up and adds two ticks, see the header.
  const float age = 1e-6F * static_cast<float>(age_us) * rate_hz + 2.999F;
  if (age_us >= 0x80000000U || age >= 65535.0F) {
    return false;
  }
  ticks = static_cast<std::uint16_t>(age);
  return true;
}

}  // namespace tactree::session
