#pragma once
// A PlantLinkBoard that can serve an application on a serial port. In that case the link of the
// control loop is the mailbox of a session, and the model is read from a store. The host selects
// this in its SessionSetup message.
// Loop and memory annotations: docs/BOUND.md.

#include "plant_link/plant_link_board.hpp"
#include "plant_link/slot_store.hpp"
#include "runtime/application.hpp"
#include "runtime/identity.hpp"
#include "tactree/session/session.hpp"

namespace tactree::firmware {

template <class Uart>
class UartBoard : public PlantLinkBoard {
 public:
  UartBoard() : store_(kIdentity.board) {}

  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault) {
    core::Configuration configuration = PlantLinkBoard::connect(last_fault);
    report_.last_fault = last_fault;
    if (is_served()) {
      store_.prepare(PlantLinkBoard::storage());
      uart_.start(timer_clock_hz(), kBaud);
      store::apply_saved_parameters(store_.parameters(), configuration);
    }
    return configuration;
  }

  /// Serves the application between the ticks and does not return. Returns immediately if
  /// is_served() is false.
  void serve(core::Controller& controller, const hal::StartResult& started,
             const core::Configuration& configuration) {
    if (!is_served()) {
      return;
    }
    static const session::BoardIdentity kBoard{kIdentity.board, TACTREE_FIRMWARE_VERSION, {}, 0};
    static session::Session<Uart, SlotStore, SessionPlatform> session(
        {uart_, store_, platform_, controller, mailbox_, kBoard});
    session.started(started, configuration, &report_);
    std::uint32_t idle = 0;
    while (true) {  // bound: for_ever
      idle = session.work() ? 0U : idle + 1U;
      if (idle > kPatience) {
        idle = 0;
        wait_for_interrupt();
      }
    }
  }

  [[nodiscard]] UartBoard& link() noexcept { return *this; }
  [[nodiscard]] const UartBoard& storage() const noexcept { return *this; }

  [[nodiscard]] std::span<const std::byte> active() const noexcept {
    return is_served() ? store_.active() : PlantLinkBoard::storage().active();
  }
  [[nodiscard]] hal::LinkInput receive() noexcept {
    hal::LinkInput input = is_served() ? mailbox_.receive() : take_message();
    operate(input);
    return input;
  }
  void send(const core::Status& status) noexcept {
    PlantLinkBoard::send(status);
    if (is_served()) {
      mailbox_.send(status, ticker().now_us());
    }
  }

 private:
  static constexpr std::uint32_t kBaud = 115200;
  /// Number of polls without data before the core sleeps until the next tick. The emulator skips
  /// the time during which the core sleeps, so no data can arrive then.
  static constexpr std::uint32_t kPatience = 2000;

  Uart uart_;
  SlotStore store_;
  SessionPlatform platform_;
  hal::StartReport report_;
  session::TickMailbox mailbox_;
};

}  // namespace tactree::firmware
