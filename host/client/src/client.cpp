#include "tactree/client/client.hpp"

#include <array>

namespace tactree::client {
namespace {

using core::wire::MessageKind;
using core::wire::WireStatus;

// Heartbeats per link timeout: one or two may be lost without ending the force.
constexpr Microseconds kBeatsPerTimeout = 5;

bool takes_long(MessageKind kind) {
  return kind == MessageKind::kBeginModel || kind == MessageKind::kFinishModel ||
         kind == MessageKind::kActivateModel || kind == MessageKind::kEraseModel ||
         kind == MessageKind::kRollBackModel || kind == MessageKind::kSaveParameters;
}

}  // namespace

std::uint16_t Client::open(std::uint16_t link_timeout_ms, std::uint32_t nonce,
                           Microseconds now_us) {
  state_ = State::kOpening;
  session_ = 0;
  nonce_ = nonce;
  knows_time_ = false;
  beat_every_us_ = 1000U * static_cast<Microseconds>(link_timeout_ms) / kBeatsPerTimeout;
  const core::wire::OpenRequest request{core::wire::kProtocolMajor, core::wire::kProtocolMinor,
                                        link_timeout_ms, nonce};
  return send(MessageKind::kOpen, request, now_us);
}

std::uint16_t Client::send(MessageKind kind, std::span<const std::byte> payload,
                           Microseconds now_us) {
  return enqueue(kind, payload, false, now_us);
}

std::uint16_t Client::enqueue(MessageKind kind, std::span<const std::byte> payload, bool own,
                              Microseconds now_us) {
  ++sequence_;
  if (session_ == 0U) {
    // Ends an older frame or stray bytes that the board may have received before.
    to_send_.push_back(static_cast<std::byte>(core::wire::kDelimiter));
  }
  std::array<std::byte, core::wire::kMaxEncodedFrame> frame{};
  const std::size_t size = core::wire::encode_frame(
      {static_cast<std::uint8_t>(kind), 0, sequence_, session_, 0}, payload, frame);
  to_send_.insert(to_send_.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
  const Microseconds limit =
      takes_long(kind) ? options_.long_timeout_us : options_.reply_timeout_us;
  outstanding_[sequence_] = {kind, now_us + limit, own};
  return sequence_;
}

void Client::sent(std::size_t bytes) {
  to_send_.erase(to_send_.begin(), to_send_.begin() + static_cast<std::ptrdiff_t>(bytes));
}

void Client::receive(std::span<const std::byte> bytes, Microseconds now_us) {
  for (const std::byte byte : bytes) {
    const auto result = decoder_.push(byte);
    if (result == core::wire::FrameDecoder::Result::kFrame) {
      take_frame(now_us);
    } else if (result == core::wire::FrameDecoder::Result::kDamaged) {
      ++damaged_;
    }
  }
}

void Client::take_frame(Microseconds now_us) {
  const core::wire::FrameHeader header = decoder_.header();
  if (header.kind == static_cast<std::uint8_t>(MessageKind::kTelemetry)) {
    Telemetry telemetry;
    if (header.session == session_ && session_ != 0U &&
        core::wire::decode_telemetry(decoder_.payload(), telemetry)) {
      see_board_time(telemetry.header.board_time_us);
      if (telemetry_) {
        telemetry_(telemetry);
      }
    }
    return;
  }
  const auto found = outstanding_.find(header.sequence);
  if (found == outstanding_.end() ||
      header.kind != (static_cast<std::uint8_t>(found->second.kind) | core::wire::kReplyBit)) {
    return;  // too late, repeated, or for another client
  }
  const Request request = found->second;
  outstanding_.erase(found);
  take_reply(header, request, now_us);
}

void Client::take_reply(const core::wire::FrameHeader& header, const Request& request,
                        Microseconds now_us) {
  const auto payload = decoder_.payload();
  Response response{request.kind,
                    header.sequence,
                    false,
                    static_cast<WireStatus>(header.status),
                    {payload.begin(), payload.end()}};
  if (response.ok()) {
    note_times(request.kind, payload);
  }
  if (request.kind == MessageKind::kOpen) {
    note_opening(response, now_us);
  } else if (response.status == WireStatus::kNoSession && header.session == session_) {
    state_ = State::kClosed;
  }
  if (request.kind == MessageKind::kClose && response.ok()) {
    state_ = State::kClosed;
    session_ = 0;
  }
  if (!request.own) {
    responses_.push_back(std::move(response));
  }
}

void Client::note_opening(const Response& response, Microseconds now_us) {
  core::wire::OpenReply reply;
  if (!response.ok() || !response.read(reply) || reply.nonce != nonce_) {
    state_ = State::kClosed;
    return;
  }
  session_ = reply.session;
  state_ = State::kOpen;
  next_beat_us_ = now_us;
}

void Client::note_times(MessageKind kind, std::span<const std::byte> payload) {
  core::wire::OpenReply opened;
  core::wire::HeartbeatReply beaten;
  core::wire::StateReply state;
  if (kind == MessageKind::kOpen && core::wire::decode_message(payload, opened)) {
    see_board_time(opened.board_time_us);
  } else if (kind == MessageKind::kHeartbeat && core::wire::decode_message(payload, beaten)) {
    see_board_time(beaten.board_time_us);
  } else if (kind == MessageKind::kState && core::wire::decode_message(payload, state)) {
    see_board_time(state.board_time_us);
  }
}

// Late messages do not decrease the time.
void Client::see_board_time(std::uint32_t time_us) {
  if (!knows_time_ || time_us - board_time_us_ < 0x80000000U) {
    board_time_us_ = time_us;
    knows_time_ = true;
  }
}

void Client::beat(Microseconds now_us) {
  const core::wire::HeartbeatRequest request{board_time_us_};
  enqueue(MessageKind::kHeartbeat, std::as_bytes(std::span(&request, 1)), true, now_us);
  next_beat_us_ = now_us + beat_every_us_;
}

void Client::advance(Microseconds now_us) {
  if (state_ == State::kOpen && beat_every_us_ != 0U && now_us >= next_beat_us_) {
    beat(now_us);
  }
  for (auto request = outstanding_.begin(); request != outstanding_.end();) {
    if (now_us < request->second.deadline_us) {
      ++request;
      continue;
    }
    if (request->second.kind == MessageKind::kOpen && state_ == State::kOpening) {
      state_ = State::kClosed;
    }
    if (!request->second.own) {
      responses_.push_back({request->second.kind, request->first, true, WireStatus::kOk, {}});
    }
    request = outstanding_.erase(request);
  }
}

bool Client::take(Response& response) {
  if (responses_.empty()) {
    return false;
  }
  response = std::move(responses_.front());
  responses_.pop_front();
  return true;
}

}  // namespace tactree::client
