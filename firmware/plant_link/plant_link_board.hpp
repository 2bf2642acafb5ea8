#pragma once
// A board in an emulator: encoders, motors, lines and the application's link are at the other end
// of the plant link; timer, flash and core are the emulated ones. To the emulated program an
// exchange takes no time.

#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/plant_link.hpp"

namespace tactree::firmware {

class PlantLinkBoard {
 public:
  /// Waits for a deadline when none has gone by, which is never so in a tick; then gives the plant
  /// what the last tick brought, and takes its message for this one.
  class Ticker {
   public:
    explicit Ticker(PlantLinkBoard& board) : board_(board) {}
    [[nodiscard]] hal::Tick wait() noexcept;
    [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }

   private:
    PlantLinkBoard& board_;
    DeadlineWait deadline_;
  };

  PlantLinkBoard() : ticker_(*this) {}
  PlantLinkBoard(const PlantLinkBoard&) = delete;
  PlantLinkBoard& operator=(const PlantLinkBoard&) = delete;

  /// Says hello and waits for the session's configuration.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault);
  /// After connect(): does the host want the board to serve an application?
  [[nodiscard]] bool is_served() const { return served_; }
  /// Tells whether there is a model to touch.
  void report(const hal::StartResult& result);

  // The parts of a board: here one object plays most of them.
  [[nodiscard]] PlantLinkBoard& encoders() noexcept { return *this; }
  [[nodiscard]] PlantLinkBoard& motors() noexcept { return *this; }
  [[nodiscard]] PlantLinkBoard& enable_line() noexcept { return *this; }
  [[nodiscard]] PlantLinkBoard& safety_inputs() noexcept { return *this; }
  [[nodiscard]] PlantLinkBoard& link() noexcept { return *this; }
  [[nodiscard]] const BlobArea& storage() const noexcept { return storage_; }
  [[nodiscard]] Ticker& ticker() noexcept { return ticker_; }

  [[nodiscard]] core::EncoderReading read() noexcept { return input_.input.encoders; }
  void write(const core::MotorCommand& command) noexcept;
  [[nodiscard]] bool healthy() noexcept { return input_.input.motors_ok; }
  [[nodiscard]] float supply_V() noexcept { return input_.input.supply_V; }
  void set(bool on) noexcept { output_.enable = on; }
  [[nodiscard]] bool read_back() noexcept { return input_.input.enable_read_back; }
  [[nodiscard]] bool emergency_stop() noexcept { return input_.input.emergency_stop; }
  [[nodiscard]] bool dead_man() noexcept { return input_.input.dead_man; }
  [[nodiscard]] hal::LinkInput receive() noexcept;
  void send(const core::Status& status) noexcept { output_.status = status; }

 private:
  void exchange();

  Ticker ticker_;
  BlobArea storage_;
  int from_host_ = -1;
  int to_host_ = -1;
  bool served_ = false;
  bool in_session_ = false;  // a tick has begun, the plant waits for its output
  hal::plant_link::TickInput input_{};
  hal::plant_link::TickOutput output_{};
};

static_assert(hal::Board<PlantLinkBoard>);

}  // namespace tactree::firmware
