#pragma once
// A PlantLinkBoard that, where the host wants it, listens to an application on a serial port: then
// the link of the control loop is a session's mailbox, and the model comes from a store.

#include "plant_link/plant_link_board.hpp"
#include "plant_link/slot_store.hpp"
#include "runtime/application.hpp"
#include "runtime/identity.hpp"
#include "tactree/hal/session/session.hpp"

namespace tactree::firmware {

template <class Uart>
class ServedBoard : public PlantLinkBoard {
 public:
  ServedBoard() : store_(kIdentity.board) {}

  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault) {
    core::Configuration configuration = PlantLinkBoard::connect(last_fault);
    report_.last_fault = last_fault;
    if (is_served()) {
      store_.prepare(PlantLinkBoard::storage());
      uart_.start(timer_clock_hz(), kBaud);
      take_saved_parameters(store_, configuration);
    }
    return configuration;
  }

  /// Where the host wants it: serves the application, between the ticks, for ever.
  void serve(core::Controller& controller, const hal::StartResult& started,
             const core::Configuration& configuration) {
    if (!is_served()) {
      return;
    }
    static const hal::BoardIdentity identity{kIdentity.board, TACTREE_FIRMWARE_VERSION, {}, 0};
    static hal::Session<Uart, SlotStore, SessionPlatform> session(
        {uart_, store_, platform_, controller, mailbox_, identity});
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

  [[nodiscard]] ServedBoard& link() noexcept { return *this; }
  [[nodiscard]] const ServedBoard& storage() const noexcept { return *this; }

  [[nodiscard]] std::span<const std::byte> active() const noexcept {
    return is_served() ? store_.active() : PlantLinkBoard::storage().active();
  }
  [[nodiscard]] hal::LinkInput receive() noexcept {
    return is_served() ? mailbox_.receive() : PlantLinkBoard::receive();
  }
  void send(const core::Status& status) noexcept {
    PlantLinkBoard::send(status);
    if (is_served()) {
      mailbox_.send(status, ticker().now_us());
    }
  }

 private:
  static constexpr std::uint32_t kBaud = 115200;
  /// So often the port is asked before the core sleeps to the next tick: while it sleeps, the
  /// emulator lets time pass at once, and nothing comes in.
  static constexpr std::uint32_t kPatience = 2000;

  Uart uart_;
  SlotStore store_;
  SessionPlatform platform_;
  hal::StartReport report_;
  hal::TickMailbox mailbox_;
};

}  // namespace tactree::firmware
