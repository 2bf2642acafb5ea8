#include "tactree/session/telemetry_sender.hpp"

#include "tactree/core/link/wire/telemetry.hpp"

namespace tactree::session {

using core::wire::WireStatus;

WireStatus TelemetrySender::subscribe(std::span<const std::byte> payload) {
  core::wire::SubscribeRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  if ((request.fields & ~core::wire::kAllTelemetry) != 0U) {
    return WireStatus::kBadValue;
  }
  fields_ = request.decimation == 0U ? 0U : request.fields;
  mailbox_.subscribe(fields_ == 0U ? 0U : request.decimation);
  return WireStatus::kOk;
}

void TelemetrySender::unsubscribe() {
  mailbox_.subscribe(0);
  fields_ = 0;
}

void TelemetrySender::send(const TickReport& report, std::uint16_t session, FrameQueue& queue) {
  if (!report.telemetry || fields_ == 0U) {
    return;
  }
  if (!queue.has_room(2)) {
    mailbox_.count_dropped();
    return;
  }
  const core::wire::Telemetry telemetry = core::wire::to_telemetry(
      {report.status.tick, report.time_us, fields_, mailbox_.dropped()}, report.status);
  std::byte bytes[core::wire::kMaxTelemetry];
  const std::size_t size = core::wire::encode_telemetry(telemetry, bytes);
  ++sequence_;
  queue.push(
      {static_cast<std::uint8_t>(core::wire::MessageKind::kTelemetry), 0, sequence_, session, 0},
      std::span<const std::byte>(bytes).first(size));
}

}  // namespace tactree::session
