#pragma once
// The application's side of the protocol (docs/PROTOCOL.md) as a state machine: its inputs are
// bytes and the time, its outputs bytes and responses. It has no I/O, clock or thread, so a test
// controls all of these. Connection (connection.hpp) runs a Client over a Transport.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/core/link/wire/telemetry.hpp"

namespace tactree::client {

using Microseconds = std::uint64_t;

struct ClientOptions {
  Microseconds reply_timeout_us = 500'000;
  /// For requests that erase flash or check a model.
  Microseconds long_timeout_us = 30'000'000;
};

/// The result of a request.
struct Response {
  core::wire::MessageKind kind{};
  std::uint16_t sequence = 0;  ///< as returned by send()
  bool timed_out = false;      ///< no reply: the board may have executed it, or not
  core::wire::WireStatus status = core::wire::WireStatus::kOk;
  std::vector<std::byte> payload;

  [[nodiscard]] bool ok() const { return !timed_out && status == core::wire::WireStatus::kOk; }
  /// Returns false if the payload is too short for the message.
  template <core::wire::Message T>
  [[nodiscard]] bool read(T& message) const {
    return core::wire::decode_message(std::span(payload), message);
  }
};

using core::wire::Telemetry;

class Client {
 public:
  enum class State : std::uint8_t { kClosed, kOpening, kOpen };

  explicit Client(const ClientOptions& options = {}) : options_(options) {}

  /// Requests a session and keeps its link alive after the reply. `nonce` must differ between
  /// processes that may use the board. The Response is available by take(), as for send().
  std::uint16_t open(std::uint16_t link_timeout_ms, std::uint32_t nonce, Microseconds now_us);

  /// Queues a request and returns its sequence number. If the request or its reply is lost, a
  /// Response with timed_out follows after the timeout. The client never repeats a request.
  std::uint16_t send(core::wire::MessageKind kind, std::span<const std::byte> payload,
                     Microseconds now_us);
  template <core::wire::Message T>
  std::uint16_t send(core::wire::MessageKind kind, const T& message, Microseconds now_us) {
    return send(kind, std::as_bytes(std::span(&message, 1)), now_us);
  }

  /// Processes received bytes.
  void receive(std::span<const std::byte> bytes, Microseconds now_us);
  /// Advances the time: queues a heartbeat if one is due, and times out requests.
  void advance(Microseconds now_us);

  /// Bytes to be sent, oldest first. sent() removes the bytes that were sent.
  [[nodiscard]] std::span<const std::byte> to_send() const { return to_send_; }
  void sent(std::size_t bytes);

  /// Removes the oldest response. Returns false if there is none.
  [[nodiscard]] bool take(Response& response);
  /// Sets the function that receive() calls for each telemetry message.
  void on_telemetry(std::function<void(const Telemetry&)> handler) {
    telemetry_ = std::move(handler);
  }

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] std::uint16_t session() const { return session_; }
  /// Newest known time of the board.
  [[nodiscard]] std::uint32_t board_time_us() const { return board_time_us_; }
  /// Number of damaged frames received.
  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }

 private:
  struct Request {
    core::wire::MessageKind kind{};
    Microseconds deadline_us = 0;
    bool own = false;  // a heartbeat of the client; has no Response
  };

  std::uint16_t enqueue(core::wire::MessageKind kind, std::span<const std::byte> payload, bool own,
                        Microseconds now_us);
  void take_frame(Microseconds now_us);
  void take_reply(const core::wire::FrameHeader& header, const Request& request,
                  Microseconds now_us);
  void note_times(core::wire::MessageKind kind, std::span<const std::byte> payload);
  void note_opening(const Response& response, Microseconds now_us);
  void see_board_time(std::uint32_t time_us);
  void beat(Microseconds now_us);

  ClientOptions options_;
  State state_ = State::kClosed;
  core::wire::FrameDecoder decoder_{};
  std::vector<std::byte> to_send_;
  std::map<std::uint16_t, Request> outstanding_;
  std::deque<Response> responses_;
  std::function<void(const Telemetry&)> telemetry_;
  std::uint16_t session_ = 0;
  std::uint16_t sequence_ = 0;
  std::uint32_t nonce_ = 0;
  std::uint32_t board_time_us_ = 0;
  bool knows_time_ = false;
  Microseconds beat_every_us_ = 0;  // 0: no heartbeats
  Microseconds next_beat_us_ = 0;
  std::uint64_t damaged_ = 0;
};

}  // namespace tactree::client
