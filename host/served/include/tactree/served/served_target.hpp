#pragma once
// The controller in this process, with an application at the other end of a port: what a board's
// firmware does beside its ticks, in the simulation.

#include <algorithm>

#include "tactree/hal/loop.hpp"
#include "tactree/hal/session/session.hpp"
#include "tactree/hal/sim/board.hpp"
#include "tactree/simulation/target.hpp"

namespace tactree::served {

/// The simulated board, but for its link: that is the session's mailbox.
class ServedBoard {
 public:
  struct Link {
    hal::TickMailbox& mailbox;
    hal::sim::SimTicker& ticker;
    [[nodiscard]] hal::LinkInput receive() noexcept { return mailbox.receive(); }
    void send(const core::Status& status) noexcept { mailbox.send(status, ticker.now_us()); }
  };

  ServedBoard(hal::sim::SimBoard& board, hal::TickMailbox& mailbox)
      : board_(board), link_{mailbox, board.ticker()} {}
  [[nodiscard]] auto& encoders() noexcept { return board_.encoders(); }
  [[nodiscard]] auto& motors() noexcept { return board_.motors(); }
  [[nodiscard]] auto& enable_line() noexcept { return board_.enable_line(); }
  [[nodiscard]] auto& safety_inputs() noexcept { return board_.safety_inputs(); }
  [[nodiscard]] auto& ticker() noexcept { return board_.ticker(); }
  [[nodiscard]] auto& storage() noexcept { return board_.storage(); }
  [[nodiscard]] Link& link() noexcept { return link_; }

 private:
  hal::sim::SimBoard& board_;
  Link link_;
};
static_assert(hal::Board<ServedBoard>);

/// Time of the simulation. Ticks and session take turns here, so there is nothing to hold.
class ServedPlatform {
 public:
  void start(hal::sim::SimTicker& ticker) { ticker_ = &ticker; }
  [[nodiscard]] std::uint32_t now_us() noexcept { return ticker_ == nullptr ? 0 : ticker_->now_us(); }
  void hold_ticks(bool) noexcept {}

 private:
  hal::sim::SimTicker* ticker_ = nullptr;
};

/// Port: a BytePort. Controller, port and store are the caller's and outlive the target.
template <hal::BytePort Port, class Store>
class ServedTarget : public simulation::Target {
 public:
  ServedTarget(core::Controller& controller, Port& port, Store& store, ServedPlatform& platform,
               const hal::BoardIdentity& identity)
      : controller_(controller),
        platform_(platform),
        session_({port, store, platform, controller, mailbox_, identity}) {}

  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override {
    platform_.start(board.ticker());
    ServedBoard served(board, mailbox_);
    const hal::StartResult result = hal::Loop(served, controller_).start(configuration);
    session_.started(result, configuration);
    return result;
  }

  core::Status tick(hal::sim::SimBoard& board) override {
    ServedBoard served(board, mailbox_);
    const core::Status status = hal::Loop(served, controller_).tick().status;
    serve();
    return status;
  }

  /// As much as the session finds to do, with an end.
  void serve() {
    for (int i = 0; i < kPiecesPerTurn && session_.work(); ++i) {
    }
  }

 private:
  static constexpr int kPiecesPerTurn = 100;

  core::Controller& controller_;
  ServedPlatform& platform_;
  hal::TickMailbox mailbox_;
  hal::Session<Port, Store, ServedPlatform> session_;
};

}  // namespace tactree::served
