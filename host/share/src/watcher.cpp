#include "tactree/share/watcher.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "tactree/core/link/wire/telemetry.hpp"

namespace tactree::share {
namespace {

using core::wire::BoardFlag;
using core::wire::FrameHeader;
using core::wire::MessageKind;
using core::wire::WireStatus;

/// Every session of a board has another number, so that no reply of an earlier one is mistaken.
std::uint16_t number_after(std::uint16_t session) {
  return session == 0xFFFFU ? std::uint16_t{1} : static_cast<std::uint16_t>(session + 1U);
}

template <core::wire::Message T>
std::vector<std::byte> bytes_of(const T& message) {
  const auto bytes = std::as_bytes(std::span(&message, 1));
  return {bytes.begin(), bytes.end()};
}

bool is_stop(std::span<const std::byte> payload) {
  core::wire::ControlRequest request;
  return decode_message(payload, request) &&
         static_cast<core::wire::ControlCode>(request.code) == core::wire::ControlCode::kStop;
}

}  // namespace

void Watcher::receive(std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) {
    if (decoder_.push(byte) == core::wire::FrameDecoder::Result::kFrame) {
      take_frame();
    }
  }
}

void Watcher::take_frame() {
  const auto kind = static_cast<MessageKind>(decoder_.header().kind);
  const bool in_session = session_ != 0U && decoder_.header().session == session_;
  if (decoder_.header().kind >= static_cast<std::uint8_t>(MessageKind::kTelemetry)) {
    return;  // not a request
  }
  if (kind == MessageKind::kOpen) {
    open();
  } else if (kind == MessageKind::kControl && is_stop(decoder_.payload())) {
    stop_wanted_ = true;
    ask(MessageKind::kState);
  } else if (in_session || kind == MessageKind::kIdentify || kind == MessageKind::kReadStart ||
             kind == MessageKind::kCapabilities) {
    take_request(kind);
  } else {
    reply(WireStatus::kNoSession);
  }
}

void Watcher::take_request(MessageKind kind) {
  switch (kind) {
    case MessageKind::kClose:
      session_ = 0;
      subscription_ = {};
      return reply(WireStatus::kOk);
    case MessageKind::kHeartbeat:
      return reply(core::wire::HeartbeatReply{board_time_us_, 0});
    case MessageKind::kSubscribe:
      return subscribe();
    case MessageKind::kIdentify:
    case MessageKind::kCapabilities:
    case MessageKind::kState:
    case MessageKind::kListModels:
    case MessageKind::kReadTrace:
    case MessageKind::kReadFault:
    case MessageKind::kReadStart:
    case MessageKind::kGetParameter:
      return ask(kind);
    case MessageKind::kControl:
    case MessageKind::kSetLimits:
    case MessageKind::kSetMaterial:
    case MessageKind::kSetTexture:
    case MessageKind::kMoveBody:
    case MessageKind::kAddForce:
    case MessageKind::kBeginModel:
    case MessageKind::kWriteModel:
    case MessageKind::kFinishModel:
    case MessageKind::kActivateModel:
    case MessageKind::kRollBackModel:
    case MessageKind::kEraseModel:
    case MessageKind::kSetParameter:
    case MessageKind::kSaveParameters:
      return reply(WireStatus::kWatchOnly);
    case MessageKind::kOpen:
    case MessageKind::kTelemetry:
      break;
  }
  reply(WireStatus::kUnknownKind);
}

void Watcher::open() {
  core::wire::OpenRequest request;
  if (!decode_message(decoder_.payload(), request)) {
    return reply(WireStatus::kBadLength);
  }
  if (request.version_major != core::wire::kProtocolMajor) {
    return reply(WireStatus::kBadVersion);
  }
  session_ = last_session_ = number_after(last_session_);
  subscription_ = {};
  core::wire::OpenReply opened;
  opened.version_minor = std::min(request.version_minor, core::wire::kProtocolMinor);
  opened.session = session_;
  opened.nonce = request.nonce;
  opened.board_time_us = board_time_us_;
  reply(opened);
}

void Watcher::subscribe() {
  core::wire::SubscribeRequest request;
  if (!decode_message(decoder_.payload(), request)) {
    return reply(WireStatus::kBadLength);
  }
  subscription_ = request;
  has_tick_ = false;
  dropped_ = 0;
  reply(WireStatus::kOk);
}

void Watcher::offer(const Snapshot& snapshot) {
  const std::uint32_t tick = snapshot.tick.header.tick;
  board_time_us_ = snapshot.tick.header.board_time_us;
  if (session_ == 0U || subscription_.decimation == 0U ||
      (has_tick_ && tick - last_tick_ < subscription_.decimation)) {
    return;
  }
  has_tick_ = true;
  last_tick_ = tick;
  if (is_full()) {
    ++dropped_;
    return;
  }
  client::Telemetry telemetry = snapshot.tick;
  telemetry.header.fields &= subscription_.fields;
  telemetry.header.dropped = dropped_;
  std::array<std::byte, core::wire::kMaxTelemetry> payload;
  const std::size_t bytes = encode_telemetry(telemetry, payload);
  FrameHeader header;
  header.kind = static_cast<std::uint8_t>(MessageKind::kTelemetry);
  header.session = session_;
  send(header, std::span(payload).first(bytes));
}

void Watcher::ask(MessageKind kind) {
  if (unanswered_ == kMaxQuestions) {
    return reply(WireStatus::kQueueFull);
  }
  ++unanswered_;
  const auto payload = decoder_.payload();
  const bool own = kind == static_cast<MessageKind>(decoder_.header().kind);
  questions_.push_back(
      {decoder_.header(), kind,
       own ? std::vector<std::byte>(payload.begin(), payload.end()) : std::vector<std::byte>()});
}

void Watcher::answer(const Question& question, const client::Response& response) {
  --unanswered_;
  if (response.timed_out) {
    return;
  }
  std::vector<std::byte> payload = response.payload;
  core::wire::CapabilitiesReply can;
  core::wire::StateReply now;
  if (question.kind == MessageKind::kCapabilities && response.ok() && response.read(can)) {
    can.flags |= static_cast<std::uint32_t>(BoardFlag::kWatchOnly) |
                 static_cast<std::uint32_t>(BoardFlag::kShared);
    std::memcpy(payload.data(), &can, sizeof can);
  } else if (static_cast<MessageKind>(question.asked.kind) == MessageKind::kControl) {
    payload = response.ok() && response.read(now)
                  ? bytes_of(core::wire::ControlReply{now.state, {}, now.faults, 0})
                  : std::vector<std::byte>();
  }
  send_reply(question.asked, response.status, payload);
}

void Watcher::reply(WireStatus status, std::span<const std::byte> payload) {
  send_reply(decoder_.header(), status, payload);
}

void Watcher::send_reply(const FrameHeader& asked, WireStatus status,
                         std::span<const std::byte> payload) {
  FrameHeader header = asked;
  header.kind |= core::wire::kReplyBit;
  header.status = static_cast<std::uint8_t>(status);
  send(header, payload);
}

void Watcher::send(const FrameHeader& header, std::span<const std::byte> payload) {
  std::array<std::byte, core::wire::kMaxEncodedFrame> frame;
  const std::size_t bytes = encode_frame(header, payload, frame);
  to_send_.insert(to_send_.end(), frame.begin(),
                  frame.begin() + static_cast<std::ptrdiff_t>(bytes));
}

void Watcher::sent(std::size_t bytes) {
  to_send_.erase(to_send_.begin(), to_send_.begin() + static_cast<std::ptrdiff_t>(bytes));
}

}  // namespace tactree::share
