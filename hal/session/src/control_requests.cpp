#include "tactree/session/control_requests.hpp"

#include "tactree/core/math/crc32.hpp"

namespace tactree::session {

using core::wire::ControlCode;
using core::wire::WireStatus;

bool ControlRequests::is_stop(core::wire::MessageKind kind, std::span<const std::byte> payload) {
  core::wire::ControlRequest request;
  return kind == core::wire::MessageKind::kControl &&
         core::wire::decode_message(payload, request) &&
         request.code == static_cast<std::uint8_t>(ControlCode::kStop);
}

void ControlRequests::stop() {
  token_ = 0;
  mailbox_.post_stop();
}

WireStatus ControlRequests::post(std::span<const std::byte> payload, const Moment& moment) {
  core::wire::ControlRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  core::Command command = core::Command::kNone;
  const WireStatus status = translate(request, moment, command);
  if (status != WireStatus::kOk) {
    return status;
  }
  const bool posted = command == core::Command::kNone || mailbox_.post_command(command);
  return posted ? WireStatus::kOk : WireStatus::kQueueFull;
}

void ControlRequests::put_reply(const core::Status& status, Reply& reply) const {
  core::wire::ControlReply message;
  message.state = static_cast<std::uint8_t>(status.state);
  message.faults = status.faults;
  message.token = status.state == core::State::kArmed ? token_ : 0U;
  reply.put(message);
}

/// Returns kOk with Command::kNone if there is nothing to do.
WireStatus ControlRequests::translate(const core::wire::ControlRequest& request,
                                      const Moment& moment, core::Command& command) {
  switch (static_cast<ControlCode>(request.code)) {
    case ControlCode::kArm:
      return arm(moment, command);
    case ControlCode::kConfirm:
      return confirm(request.token, command);
    case ControlCode::kClearFault:
      command = core::Command::kClearFault;
      return WireStatus::kOk;
    case ControlCode::kHome:
      command = core::Command::kHome;
      return controller_.motors_off() ? WireStatus::kOk : WireStatus::kBusy;
    default:
      return WireStatus::kBadValue;
  }
}

// While armed, a repeated arm request gets the same token: the first reply may have been lost.
WireStatus ControlRequests::arm(const Moment& moment, core::Command& command) {
  const core::State state = controller_.state();
  if (state == core::State::kArmed && token_ != 0U) {
    return WireStatus::kOk;
  }
  if (state != core::State::kIdle) {
    return WireStatus::kNotNow;
  }
  if (!controller_.homed()) {
    return WireStatus::kNotHomed;
  }
  if (moment.flash_busy) {
    return WireStatus::kBusy;
  }
  command = core::Command::kArm;
  token_ = make_token(moment);
  return WireStatus::kOk;
}

WireStatus ControlRequests::confirm(std::uint32_t token, core::Command& command) const {
  // With a dead-man control, only the hand can confirm.
  if (controller_.configuration().supervision.dead_man_required ||
      controller_.state() != core::State::kArmed) {
    return WireStatus::kNotNow;
  }
  if (token == 0U || token != token_) {
    return WireStatus::kBadToken;
  }
  command = core::Command::kArm;
  return WireStatus::kOk;
}

// Makes a new token, never 0. It is not a secret: it protects against messages sent by mistake.
std::uint32_t ControlRequests::make_token(const Moment& moment) {
  ++tokens_;
  const std::uint32_t words[3] = {moment.now_us, tokens_, moment.session};
  const std::uint32_t token = core::crc32(std::as_bytes(std::span(words)));
  return token == 0U ? 1U : token;
}

}  // namespace tactree::session
