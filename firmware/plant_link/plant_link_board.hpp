#pragma once
// A board in an emulator. The host simulates encoders, motors, lines, button, lamp and the link of
// the application over the plant link; timer, flash and core are emulated. An exchange takes no
// emulated time.

#include "platform.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/panel.hpp"
#include "tactree/hal/plant_link.hpp"

namespace tactree::firmware {

class PlantLinkBoard {
 public:
  /// Waits for the next deadline, which has already passed if wait() is called from the tick
  /// interrupt. Then sends the output of the last tick to the plant and receives the input of this
  /// tick.
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

  /// Identifies the board to the host and waits for the configuration of the session.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault);
  /// True if the host requested a session that serves an application. Precondition: connect() was
  /// called.
  [[nodiscard]] bool is_served() const { return served_; }
  /// Sends the result of the start to the host.
  void report(const hal::StartResult& result);

  // The parts of a board; this object implements most of them.
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
  [[nodiscard]] hal::LinkInput receive() noexcept {
    hal::LinkInput input = take_message();
    operate(input);
    return input;
  }
  void send(const core::Status& status) noexcept;

 protected:
  /// The message of the host's application.
  [[nodiscard]] hal::LinkInput take_message() noexcept;
  /// Adds the command of the button to the input of a link.
  void operate(hal::LinkInput& input) noexcept;

 private:
  void exchange();

  Ticker ticker_;
  BlobArea storage_;
  hal::Panel panel_;
  int from_host_ = -1;
  int to_host_ = -1;
  bool served_ = false;
  bool in_session_ = false;  // a tick has begun, and the plant waits for its output
  hal::plant_link::TickInput input_{};
  hal::plant_link::TickOutput output_{};
};

static_assert(hal::Board<PlantLinkBoard>);

}  // namespace tactree::firmware
