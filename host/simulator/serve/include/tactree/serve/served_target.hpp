#pragma once
// A controller in this process that speaks the protocol of a board. It runs the firmware's session,
// model store and control loop on simulated flash.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "tactree/client/transport.hpp"
#include "tactree/core/crypto/signature.hpp"
#include "tactree/hal/sim/flash.hpp"
#include "tactree/session/session.hpp"
#include "tactree/simulation/target.hpp"
#include "tactree/store/model_store.hpp"

namespace tactree::serve {

/// A simulated board with a session as its link and a model store as its storage.
class ServedSimBoard {
 public:
  /// The link of an application, with the panel of the board.
  class Link {
   public:
    Link(session::TickMailbox& mailbox, hal::sim::SimBoard& board)
        : mailbox_{mailbox, board.ticker()}, panel_(board.panel()) {}
    [[nodiscard]] hal::LinkInput receive() noexcept {
      hal::LinkInput input = mailbox_.receive();
      panel_.operate(input);
      return input;
    }
    void send(const core::Status& status) noexcept {
      mailbox_.send(status);
      panel_.show(status);
    }

   private:
    session::MailboxLink<hal::sim::SimTicker> mailbox_;
    hal::sim::SimPanel& panel_;
  };
  using Store = store::ModelStore<hal::sim::SimFlash>;

  ServedSimBoard(hal::sim::SimBoard& board, session::TickMailbox& mailbox, const Store& store)
      : board_(board), link_(mailbox, board), store_(store) {}

  [[nodiscard]] hal::sim::SimEncoderBank& encoders() noexcept { return board_.encoders(); }
  [[nodiscard]] hal::sim::SimMotorBank& motors() noexcept { return board_.motors(); }
  [[nodiscard]] hal::sim::SimEnableLine& enable_line() noexcept { return board_.enable_line(); }
  [[nodiscard]] hal::sim::SimSafetyInputs& safety_inputs() noexcept {
    return board_.safety_inputs();
  }
  [[nodiscard]] hal::sim::SimTicker& ticker() noexcept { return board_.ticker(); }
  [[nodiscard]] Link& link() noexcept { return link_; }
  [[nodiscard]] const Store& storage() const noexcept { return store_; }
  [[nodiscard]] hal::sim::SessionRecorder* recorder() noexcept { return board_.recorder(); }

 private:
  hal::sim::SimBoard& board_;
  Link link_;
  const Store& store_;
};

struct ServeOptions {
  /// Ed25519 public key that must verify the signature of a model. Without a key, no signature is
  /// required.
  std::optional<std::array<std::uint8_t, core::kPublicKeyBytes>> key;
  std::uint32_t slot_bytes = 16U << 20U;  ///< of each slot of the model store
  std::uint32_t serial = 0;               ///< last word of the unique number
};

/// Ticks and session run in the same thread, therefore hold_ticks() has no effect.
class ServedPlatform {
 public:
  void start(hal::sim::SimBoard& board) { board_ = &board; }
  /// Simulated time, us; 0 before the start.
  [[nodiscard]] std::uint32_t now_us() noexcept {
    return board_ == nullptr ? 0U : board_->ticker().now_us();
  }
  [[nodiscard]] hal::sim::SessionRecorder* recorder() noexcept {
    return board_ == nullptr ? nullptr : board_->recorder();
  }
  void hold_ticks(bool) noexcept {}

 private:
  hal::sim::SimBoard* board_ = nullptr;
};

class ServedTarget : public simulation::Target {
 public:
  /// `model` is in use until another model is written. `model` and `transport` must outlive the
  /// target.
  ServedTarget(client::Transport& transport, std::span<const std::byte> model,
               const ServeOptions& options);
  ~ServedTarget() override;

  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override;
  /// Executes one tick, then work().
  core::Status tick(hal::sim::SimBoard& board) override;
  /// Runs the session, also between ticks.
  void work();

  // For components of a board other than the session, for example USB.
  [[nodiscard]] core::Controller& controller() { return controller_; }
  [[nodiscard]] ServedSimBoard::Store& store() { return store_; }
  [[nodiscard]] session::TickMailbox& mailbox() { return mailbox_; }
  [[nodiscard]] ServedPlatform& platform() { return platform_; }

 private:
  class Running;

  client::Transport& transport_;
  ServeOptions options_;
  hal::sim::SimFlash flash_;
  core::Controller controller_;
  ServedPlatform platform_;
  session::TickMailbox mailbox_;
  ServedSimBoard::Store store_;
  std::unique_ptr<Running> running_;
};

}  // namespace tactree::serve
