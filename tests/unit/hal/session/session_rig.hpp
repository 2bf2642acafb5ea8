#pragma once
// A board with a session, and a client, over a link that a test spoils; in one thread, in steps of
// a tick. The board touches a sphere; its device stands still outside of it, or inside on demand.

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "await_response.hpp"
#include "tactree/client/client.hpp"
#include "tactree/hal/sim/board.hpp"
#include "tactree/session/session.hpp"
#include "tactree/store/no_model_store.hpp"
#include "test_models.hpp"

namespace tactree::test {

/// One direction of a link; a spoiler may change, delay or drop each frame.
class Wire {
 public:
  struct Delivery {
    std::uint64_t tick = 0;
    std::vector<std::byte> bytes;
  };
  using Spoiler = std::function<std::vector<Delivery>(std::uint64_t number, std::uint64_t tick,
                                                      const std::vector<std::byte>& frame)>;

  void spoil(Spoiler spoiler) { spoiler_ = std::move(spoiler); }
  void send(std::span<const std::byte> bytes, std::uint64_t tick);
  /// Bytes that have arrived, in the order of arrival.
  [[nodiscard]] std::vector<std::byte> arrived(std::uint64_t tick);
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// All frames as sent, before the spoiler.
  [[nodiscard]] const std::vector<std::vector<std::byte>>& sent() const { return sent_; }

 private:
  Spoiler spoiler_;
  std::vector<std::byte> begun_;
  std::vector<Delivery> on_its_way_;
  std::vector<std::vector<std::byte>> sent_;
  std::uint64_t frames_ = 0;
};

/// The board's end.
class TestPort {
 public:
  TestPort(Wire& to_board, Wire& to_host, const std::uint64_t& tick)
      : to_board_(to_board), to_host_(to_host), tick_(tick) {}
  std::size_t read(std::span<std::byte> bytes) noexcept;
  std::size_t write(std::span<const std::byte> bytes) noexcept;

  /// Simulates a blocked driver: no bytes in either direction.
  bool stuck = false;

 private:
  Wire& to_board_;
  Wire& to_host_;
  const std::uint64_t& tick_;
  std::deque<std::byte> waiting_;
};

/// A SimBoard whose link is the session's mailbox.
class SessionBoard : public hal::sim::SimBoard {
 public:
  using Link = session::MailboxLink<hal::sim::SimTicker>;
  SessionBoard(std::span<const std::byte> blob, session::TickMailbox& mailbox)
      : SimBoard({}, blob), link_{mailbox, ticker()} {}
  [[nodiscard]] Link& link() noexcept { return link_; }

 private:
  Link link_;
};

struct TestPlatform {
  hal::sim::SimTicker& ticker;
  bool held = false;
  [[nodiscard]] std::uint32_t now_us() noexcept { return ticker.now_us(); }
  void hold_ticks(bool hold) noexcept { held = hold; }
};

template <class Store = store::NoModelStore>
class SessionRig {
 public:
  explicit SessionRig(Store& store, const core::Configuration& configuration,
                      std::span<const std::byte> blob)
      : board_(blob, mailbox_),
        session_({port_, store, platform_, controller_, mailbox_, kIdentity}),
        loop_(board_, controller_) {
    stand_at(0.05);
    start_ = loop_.start(configuration);
    session_.started(start_, configuration, &start_report);
    settle(10);
  }

  static core::Configuration configuration() {
    core::Configuration c;
    c.device.homing = core::HomingMethod::kAbsolute;
    c.supervision.dead_man_required = false;
    c.supervision.stuck_s = 1.0F;  // nothing moves here, whatever the motors do
    return c;
  }

  /// Moves the device to x_m along x, m, at 2 m/s; 0.05 is outside the sphere of 0.03.
  void stand_at(double x_m) { goal_m_ = x_m; }

  [[nodiscard]] TestPort& port() { return port_; }

  /// One tick of board and client.
  const core::Status& tick() {
    ++tick_;
    place_[0] += std::clamp(goal_m_ - place_[0], -0.002, 0.002);
    board_.sample(place_);
    status_ = loop_.tick().status;
    while (session_.work()) {
    }
    const std::vector<std::byte> bytes = to_host_.arrived(tick_);
    client_.receive(bytes, now_us());
    client_.advance(now_us());
    if (!client_.to_send().empty()) {
      to_board_.send(client_.to_send(), tick_);
      client_.sent(client_.to_send().size());
    }
    if (after_tick) {
      after_tick();
    }
    return status_;
  }
  void settle(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      tick();
    }
  }

  /// Waits for the response to a request. Everything else that comes is dropped.
  client::Response await(std::uint16_t sequence, int ticks_max = 40000) {
    int ticks = 0;
    return test::await_response(
        client_, sequence, [&] { return ticks++ < ticks_max; }, [&] { tick(); });
  }
  template <core::wire::Message T>
  client::Response ask(core::wire::MessageKind kind, const T& message) {
    return await(client_.send(kind, message, now_us()));
  }
  client::Response ask(core::wire::MessageKind kind) {
    return await(client_.send(kind, std::span<const std::byte>(), now_us()));
  }
  client::Response open(std::uint16_t link_timeout_ms = 0, std::uint32_t nonce = 7) {
    return await(client_.open(link_timeout_ms, nonce, now_us()));
  }
  client::Response control(core::wire::ControlCode code, std::uint32_t token = 0) {
    return ask(core::wire::MessageKind::kControl,
               core::wire::ControlRequest{static_cast<std::uint8_t>(code), {}, token});
  }
  /// To active, as a careful application does it. False: it did not get there.
  bool arm() {
    const client::Response armed = control(core::wire::ControlCode::kArm);
    core::wire::ControlReply reply;
    if (!armed.ok() || !armed.read(reply)) {
      return false;
    }
    settle(20);  // the enable line follows
    const client::Response confirmed = control(core::wire::ControlCode::kConfirm, reply.token);
    return confirmed.ok() && state() == core::State::kActive;
  }

  [[nodiscard]] client::Microseconds now_us() const { return 1000U * tick_; }
  [[nodiscard]] std::uint64_t ticks() const { return tick_; }
  [[nodiscard]] core::State state() const { return controller_.state(); }
  [[nodiscard]] const core::Status& status() const { return status_; }
  [[nodiscard]] core::Controller& controller() { return controller_; }
  [[nodiscard]] client::Client& client() { return client_; }
  [[nodiscard]] Wire& to_board() { return to_board_; }
  [[nodiscard]] Wire& to_host() { return to_host_; }
  [[nodiscard]] SessionBoard& board() { return board_; }
  [[nodiscard]] const hal::StartResult& start_result() const { return start_; }
  /// Starts a new client, as after a crash of the application.
  void replace_client() { client_ = client::Client(); }

  std::function<void()> after_tick;
  hal::StartReport start_report{};

 private:
  static constexpr session::BoardIdentity kIdentity{"test", "1.2.3", {1, 2, 3}, 0};

  std::uint64_t tick_ = 0;
  double goal_m_ = 0.05;
  double place_[core::kAxes] = {0.05, 0.0, 0.0};
  Wire to_board_;
  Wire to_host_;
  TestPort port_{to_board_, to_host_, tick_};
  session::TickMailbox mailbox_;
  SessionBoard board_;
  TestPlatform platform_{board_.ticker()};
  core::Controller controller_;
  session::Session<TestPort, Store, TestPlatform> session_;
  hal::Loop<SessionBoard> loop_;
  hal::StartResult start_;
  client::Client client_;
  core::Status status_;
};

}  // namespace tactree::test
