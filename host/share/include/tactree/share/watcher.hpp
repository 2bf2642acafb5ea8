#pragma once
// A program that watches a shared board with the protocol of boards (docs/PROTOCOL.md): the board's
// side of its connection as a state machine, without a socket, clock or thread. To the program it
// looks like a board that an application may only watch and stop (BoardFlag::kShared).

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tactree/client/client.hpp"
#include "tactree/share/snapshot.hpp"

namespace tactree::share {

class Watcher {
 public:
  /// Bytes that wait for a program that does not read. Beyond, it gets no telemetry, and its
  /// requests are not to be read.
  static constexpr std::size_t kMaxWaiting = 65536;
  /// Requests of a program that wait for the board; others are refused.
  static constexpr std::size_t kMaxQuestions = 8;

  /// A request for the board. Give it back to answer().
  struct Question {
    core::wire::FrameHeader asked{};  ///< of the program's request
    core::wire::MessageKind kind{};
    std::vector<std::byte> payload;
  };

  /// Processes bytes of the program.
  void receive(std::span<const std::byte> bytes);
  /// Queues the telemetry of a tick, if the program has subscribed to it.
  void offer(const Snapshot& snapshot);
  /// The questions since the last call.
  [[nodiscard]] std::vector<Question> take_questions() { return std::exchange(questions_, {}); }
  /// The program has requested a stop since the last call. Execute it before the questions.
  [[nodiscard]] bool take_stop() { return std::exchange(stop_wanted_, false); }
  /// The reply of the board. Without one, the program gets none.
  void answer(const Question& question, const client::Response& response);

  /// Bytes for the program, oldest first. sent() removes the bytes that were sent.
  [[nodiscard]] std::span<const std::byte> to_send() const { return to_send_; }
  void sent(std::size_t bytes);
  [[nodiscard]] bool is_full() const { return to_send_.size() > kMaxWaiting; }

 private:
  void take_frame();
  void take_request(core::wire::MessageKind kind);
  void open();
  void subscribe();
  void ask(core::wire::MessageKind kind);
  void reply(core::wire::WireStatus status, std::span<const std::byte> payload = {});
  template <core::wire::Message T>
  void reply(const T& message) {
    reply(core::wire::WireStatus::kOk, std::as_bytes(std::span(&message, 1)));
  }
  void send(const core::wire::FrameHeader& header, std::span<const std::byte> payload);
  void send_reply(const core::wire::FrameHeader& asked, core::wire::WireStatus status,
                  std::span<const std::byte> payload);

  core::wire::FrameDecoder decoder_{};
  std::vector<Question> questions_;
  std::size_t unanswered_ = 0;
  bool stop_wanted_ = false;
  std::vector<std::byte> to_send_;
  std::uint16_t session_ = 0;  // 0: none
  std::uint16_t last_session_ = 0;
  core::wire::SubscribeRequest subscription_{};
  bool has_tick_ = false;  // since the subscription
  std::uint32_t last_tick_ = 0;
  std::uint32_t dropped_ = 0;
  std::uint32_t board_time_us_ = 0;
};

}  // namespace tactree::share
