#pragma once
// A controller in this process that an application may talk to, as to a board: the session, the
// model store and the control loop are those of the firmware, the flash is simulated.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "tactree/hal/session/session.hpp"
#include "tactree/hal/sim/flash.hpp"
#include "tactree/hal/store/model_store.hpp"
#include "tactree/host/transport.hpp"
#include "tactree/simulation/target.hpp"

namespace tactree::serve {

/// A simulated board whose loop listens to a session and takes its model from a store.
class ServedBoard {
 public:
  using Link = hal::MailboxLink<hal::sim::SimTicker>;
  using Store = hal::ModelStore<hal::sim::SimFlash>;

  ServedBoard(hal::sim::SimBoard& board, hal::TickMailbox& mailbox, const Store& store)
      : board_(board), link_{mailbox, board.ticker()}, store_(store) {}

  [[nodiscard]] hal::sim::SimEncoderBank& encoders() noexcept { return board_.encoders(); }
  [[nodiscard]] hal::sim::SimMotorBank& motors() noexcept { return board_.motors(); }
  [[nodiscard]] hal::sim::SimEnableLine& enable_line() noexcept { return board_.enable_line(); }
  [[nodiscard]] hal::sim::SimSafetyInputs& safety_inputs() noexcept {
    return board_.safety_inputs();
  }
  [[nodiscard]] hal::sim::SimTicker& ticker() noexcept { return board_.ticker(); }
  [[nodiscard]] Link& link() noexcept { return link_; }
  [[nodiscard]] const Store& storage() const noexcept { return store_; }

 private:
  hal::sim::SimBoard& board_;
  Link link_;
  const Store& store_;
};

struct ServeOptions {
  /// Ed25519 key whose owner has to have signed a model; none: no signature is required.
  std::optional<std::array<std::uint8_t, core::kPublicKeyBytes>> key;
  std::uint32_t slot_bytes = 16U << 20U;
  std::uint32_t serial = 0;  ///< last word of its unique number
};

/// Ticks and session are in one thread: nothing is to be held.
class ServedPlatform {
 public:
  void start(hal::sim::SimTicker& ticker) { ticker_ = &ticker; }
  /// 0 before the start.
  [[nodiscard]] std::uint32_t now_us() noexcept {
    return ticker_ == nullptr ? 0U : ticker_->now_us();
  }
  void hold_ticks(bool) noexcept {}

 private:
  hal::sim::SimTicker* ticker_ = nullptr;
};

class ServedTarget : public simulation::Target {
 public:
  /// `model`: in use until another is written; must outlive the target, as must the transport.
  ServedTarget(host::Transport& transport, std::span<const std::byte> model,
               const ServeOptions& options);
  ~ServedTarget() override;

  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override;
  /// One tick, and what the session has to do until the next.
  core::Status tick(hal::sim::SimBoard& board) override;
  /// What the session has to do, also between ticks.
  void work();

  // For what else a board has beside its session.
  [[nodiscard]] core::Controller& controller() { return controller_; }
  [[nodiscard]] ServedBoard::Store& store() { return store_; }
  [[nodiscard]] hal::TickMailbox& mailbox() { return mailbox_; }
  [[nodiscard]] ServedPlatform& platform() { return platform_; }

 private:
  class Running;

  host::Transport& transport_;
  ServeOptions options_;
  hal::sim::SimFlash flash_;
  core::Controller controller_;
  ServedPlatform platform_;
  hal::TickMailbox mailbox_;
  ServedBoard::Store store_;
  std::unique_ptr<Running> running_;
};

}  // namespace tactree::serve
