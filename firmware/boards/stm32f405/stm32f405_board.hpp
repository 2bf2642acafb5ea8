#pragma once
// A board with an STM32F405, three encoders and three amplifiers. README.md in this folder lists
// the pins and the tests that were run. `Word` is the type of a register (stm32f4/registers.hpp);
// the tests run the whole board on simulated registers.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "platform.hpp"
#include "runtime/application.hpp"
#include "runtime/blob_area.hpp"
#include "runtime/deadline_wait.hpp"
#include "stm32f4/clocks.hpp"
#include "stm32f4/lines.hpp"
#include "stm32f4/link_port.hpp"
#include "stm32f4/pwm_motors.hpp"
#include "stm32f4/quadrature_encoders.hpp"
#include "stm32f4/serial_port.hpp"
#include "stm32f4/store_flash.hpp"
#include "stm32f4/usb_otg_fs.hpp"
#include "stm32f4/watchdog.hpp"
#include "tactree/core/link/usb/parameter_storage.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/panel.hpp"
#include "tactree/hal/usb_device.hpp"
#include "tactree/session/dfu_model.hpp"
#include "tactree/session/session.hpp"
#include "tactree/store/model_store.hpp"
#include "wiring.hpp"

namespace tactree::firmware {

/// Switches to full clock speed and enables the clock of every peripheral in use. Call once after a
/// reset, before any other access to the chip.
template <class Word>
[[nodiscard]] stm32f4::ClockFailure prepare_chip(const stm32f4::Chip<Word>& chip) {
  const stm32f4::ClockFailure failure =
      stm32f4::start_clocks(chip.rcc, chip.flash, chip.tim11, wiring::kCrystalMHz);
  stm32f4::set(chip.rcc.ahb1enr, wiring::kAhb1Clocks);
  stm32f4::set(chip.rcc.ahb2enr, wiring::kAhb2Clocks);
  stm32f4::set(chip.rcc.apb1enr, wiring::kApb1Clocks);
  stm32f4::set(chip.rcc.apb2enr, wiring::kApb2Clocks);
  (void)stm32f4::read(chip.rcc.apb2enr);  // usable two cycles after the clock is enabled
  return failure;
}

/// Flash regions of the model store: its records and its two slots. linker/stm32f405.ld lists the
/// use of all sectors.
inline constexpr stm32f4::FlashRegion kRecordSectors{1, 2, 4096};
inline constexpr stm32f4::FlashRegion kSlotSectors{6, 6, 32768};

constexpr core::wire::StartPart part_of(stm32f4::ClockFailure failure) {
  using stm32f4::ClockFailure;
  using Part = core::wire::StartPart;
  return failure == ClockFailure::kCrystal      ? Part::kCrystal
         : failure == ClockFailure::kFrequency  ? Part::kCrystalFrequency
         : failure == ClockFailure::kWaitStates ? Part::kWaitStates
         : failure == ClockFailure::kPll        ? Part::kPll
                                                : Part::kClockSwitch;
}

/// `Word` is the type of a register, `Cell` that of a word of flash (FlashProgrammer).
template <class Word, class Cell = Word>
class Stm32f405Board {
 public:
  using Part = core::wire::StartPart;

  /// Refreshes the watchdog at the start of each tick. It is otherwise refreshed only around an
  /// erase, so a tick that hangs causes a reset.
  class Ticker {
   public:
    explicit Ticker(Stm32f405Board& board) : board_(board) {}
    [[nodiscard]] hal::Tick wait() noexcept {
      const std::uint32_t missed = deadline_.wait();
      board_.watchdog_.refresh();
      return {missed};
    }
    [[nodiscard]] std::uint32_t now_us() noexcept { return firmware::now_us(); }

   private:
    Stm32f405Board& board_;
    DeadlineWait deadline_;
  };

  /// The motors of the board. healthy() also returns false if any part of the board failed to
  /// start.
  class Motors {
   public:
    explicit Motors(Stm32f405Board& board) : board_(board) {}
    void write(const core::MotorCommand& command) noexcept { board_.pwm_.write(command); }
    [[nodiscard]] bool healthy() noexcept { return board_.started() && board_.pwm_.healthy(); }

   private:
    Stm32f405Board& board_;
  };

  /// Switches the power of the amplifiers off and holds the ticks, because the processor stalls
  /// during an erase. If the watchdog's timeout cannot be extended, nothing is erased. If it cannot
  /// be restored, healthy() returns false and the motors stay off until the next reset.
  class Standstill {
   public:
    explicit Standstill(Stm32f405Board& board) : board_(board) {}
    [[nodiscard]] bool begin() noexcept {
      firmware::hold_ticks(true);
      board_.enable_line_.set(false);
      return board_.watchdog_.set(stm32f4::kTimeOfErasing);
    }
    void end() noexcept {
      board_.note(board_.watchdog_.set(stm32f4::kTimeOfTicks), Part::kWatchdog);
      firmware::hold_ticks(false);
    }

   private:
    Stm32f405Board& board_;
  };

  /// The link of an application, with the button and the lamp of the board.
  class Link {
   public:
    explicit Link(Stm32f405Board& board) : board_(board), mailbox_{board.mailbox_, board.ticker_} {}
    [[nodiscard]] hal::LinkInput receive() noexcept {
      hal::LinkInput input = mailbox_.receive();
      board_.panel_.operate(board_.arm_button_.is_pressed(), input);
      return input;
    }
    void send(const core::Status& status) noexcept {
      mailbox_.send(status);
      board_.lamp_.drive(board_.panel_.lamp(status));
    }

   private:
    Stm32f405Board& board_;
    session::MailboxLink<Ticker> mailbox_;
  };

  using Flash = stm32f4::StoreFlash<Word, Cell, Standstill>;
  using Store = store::ModelStore<Flash, Flash, wiring::kModelKey != nullptr>;

  /// Serves an application between the ticks: the session at either port, and the requests of a USB
  /// host.
  class Application {
   public:
    using Model = session::DfuModel<Store, SessionPlatform>;
    using Parameters = core::usb::ParameterStorage<SessionPlatform>;
    using Usb = hal::UsbDevice<stm32f4::UsbOtgFs<Word>, Model, Parameters>;
    using Port = stm32f4::LinkPort<Usb, stm32f4::SerialPort<Word>>;

    /// Keeps both references. Precondition: connect() was called.
    Application(Stm32f405Board& board, core::Controller& controller)
        : board_(board),
          controller_(controller),
          model_(board.store_, controller, board.mailbox_, board.platform_),
          parameters_(controller, board.platform_),
          usb_(board.otg_, board.usb_identity(), false, model_, parameters_),
          port_(usb_, board.port_),
          session_({port_, board.store_, board.platform_, controller, board.mailbox_,
                    board.identity_}) {}

    /// Call before work(): Session::started().
    void started(const hal::StartResult& result, const core::Configuration& configuration) {
      session_.started(result, configuration, &board_.report_);
    }
    /// A bounded piece of work: UsbDevice::poll() and Session::work().
    void work() {
      usb_.poll(board_.platform_.now_us());
      (void)session_.work();
      usb_.send_changes({controller_.tick(), static_cast<std::uint32_t>(controller_.state()),
                         controller_.faults(), controller_.limits()});
    }

   private:
    Stm32f405Board& board_;
    core::Controller& controller_;
    Model model_;
    Parameters parameters_;
    Usb usb_;
    Port port_;
    session::Session<Port, Store, SessionPlatform> session_;
  };

  /// `clocks` is the result of prepare_chip().
  Stm32f405Board(const stm32f4::Chip<Word>& chip, const stm32f4::FlashCells<Cell>& cells,
                 stm32f4::ClockFailure clocks, const session::BoardIdentity& identity)
      : chip_(chip),
        identity_(identity),
        full_speed_(clocks == stm32f4::ClockFailure::kNone),
        encoders_({chip.tim2, stm32f4::CounterWidth::k32}, {chip.tim5, stm32f4::CounterWidth::k32},
                  {chip.tim4, stm32f4::CounterWidth::k16}),
        pwm_(chip.tim8, {pin_c(0), pin_c(1), pin_c(2)}, pin_b(14), wiring::kEffortAtFullWidth),
        enable_line_(pin_c(4), pin_c(5), pwm_),
        safety_inputs_(pin_b(12), pin_b(13)),
        arm_button_(pin_b(15)),
        lamp_(pin_c(3)),
        port_(chip.usart1, chip.dma2, ring_),
        otg_(chip.otg_fs),
        watchdog_(chip.watchdog),
        standstill_(*this),
        record_flash_(chip.flash, cells, kRecordSectors, standstill_),
        slot_flash_(chip.flash, cells, kSlotSectors, standstill_),
        store_(slot_flash_, record_flash_, {identity_.board, wiring::kModelKey, {}}),
        motors_(*this),
        ticker_(*this),
        link_(*this) {
    if (!full_speed_) {
      report_.miss(part_of(clocks));
    }
  }
  Stm32f405Board(const Stm32f405Board&) = delete;
  Stm32f405Board& operator=(const Stm32f405Board&) = delete;

  /// Starts every part. Returns the configuration of wiring.hpp with the saved calibration applied.
  [[nodiscard]] core::Configuration connect(const hal::CapturedFault& last_fault) {
    report_.by_watchdog = stm32f4::take_watchdog_reset(chip_.rcc);
    report_.last_fault = last_fault;
    note(enable_line_.start(), Part::kEnableLine);
    note(safety_inputs_.start(), Part::kSafetyInputs);
    note(arm_button_.start(), Part::kSafetyInputs);
    lamp_.make_output();
    prepare_encoder_pins();
    note(encoders_.start(), Part::kEncoders);
    prepare_motor_pins();
    note(pwm_.start(), Part::kMotors);
    pin_a(9).make_alternate(wiring::kUsart1Function, stm32f4::Pull::kUp);
    pin_a(10).make_alternate(wiring::kUsart1Function, stm32f4::Pull::kUp);
    note(port_.start(full_speed_ ? stm32f4::kApb2Hz : stm32f4::kInternalClockHz, wiring::kBaud),
         Part::kReceiver);
    if (full_speed_) {
      start_usb();
    }
    store_.set_factory(BlobArea().active());
    (void)store_.mount();
    core::Configuration configuration = wiring::configuration();
    store::apply_saved_parameters(store_.parameters(), configuration);
    panel_.configure(configuration.rate_hz);
    return configuration;
  }

  /// Starts the watchdog. It must not start in connect(), because the check of a large model, which
  /// follows, would exceed its timeout. serve() reports `result` over the link.
  void report(const hal::StartResult& result) {
    note(watchdog_.start(), Part::kWatchdog);
    if (result.image != hal::ImageStatus::kOk) {
      panel_.refuse_program();
    }
  }

  /// Serves an application between the ticks. Does not return.
  void serve(core::Controller& controller, const hal::StartResult& started,
             const core::Configuration& configuration) {
    static Application application(*this, controller);
    application.started(started, configuration);
    while (true) {  // bound: for_ever
      application.work();
    }
  }

  [[nodiscard]] stm32f4::QuadratureEncoders<Word>& encoders() noexcept { return encoders_; }
  [[nodiscard]] Motors& motors() noexcept { return motors_; }
  [[nodiscard]] stm32f4::EnableLine<Word>& enable_line() noexcept { return enable_line_; }
  [[nodiscard]] stm32f4::SafetyInputs<Word>& safety_inputs() noexcept { return safety_inputs_; }
  [[nodiscard]] Link& link() noexcept { return link_; }
  [[nodiscard]] const Store& storage() const noexcept { return store_; }
  [[nodiscard]] Ticker& ticker() noexcept { return ticker_; }

  /// The parts that failed to start, and the cause of the last reset.
  [[nodiscard]] const hal::StartReport& start_report() const noexcept { return report_; }

  /// The receive buffer, for tests: a simulated DMA cannot read it through a 32-bit address
  /// register.
  [[nodiscard]] stm32f4::Ring& ring() noexcept { return ring_; }

 private:
  stm32f4::Pin<Word> pin_a(std::uint32_t number) const { return {chip_.gpio_a, number}; }
  stm32f4::Pin<Word> pin_b(std::uint32_t number) const { return {chip_.gpio_b, number}; }
  stm32f4::Pin<Word> pin_c(std::uint32_t number) const { return {chip_.gpio_c, number}; }

  // The pull-ups keep the level of an unconnected track constant.
  void prepare_encoder_pins() {
    pin_a(15).make_alternate(wiring::kTim2Function, stm32f4::Pull::kUp);
    pin_b(3).make_alternate(wiring::kTim2Function, stm32f4::Pull::kUp);
    pin_a(0).make_alternate(wiring::kTim5Function, stm32f4::Pull::kUp);
    pin_a(1).make_alternate(wiring::kTim5Function, stm32f4::Pull::kUp);
    pin_b(6).make_alternate(wiring::kTim4Function, stm32f4::Pull::kUp);
    pin_b(7).make_alternate(wiring::kTim4Function, stm32f4::Pull::kUp);
  }

  // The pull-downs keep the PWM inputs low while the timer does not drive them; a broken failure
  // line reads as a failure.
  void prepare_motor_pins() {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {  // bound: kAxes
      pin_c(axis).make_output();
      pin_c(6U + axis).make_alternate(wiring::kTim8Function, stm32f4::Pull::kDown);
    }
    pin_b(14).make_input(stm32f4::Pull::kDown);
  }

  // Without the crystal there are no 48 MHz. The serial number is read only from a chip that has
  // the core: an emulator has neither.
  void start_usb() {
    pin_a(11).make_alternate(wiring::kOtgFsFunction, stm32f4::Pull::kNone);
    pin_a(12).make_alternate(wiring::kOtgFsFunction, stm32f4::Pull::kNone);
    const bool started = otg_.start();
    note(started, Part::kUsb);
    for (std::uint32_t i = 0; started && i < 3U; ++i) {  // bound: 3
      identity_.serial[i] = stm32f4::read(chip_.unique_id.word[i]);
    }
  }

  [[nodiscard]] core::usb::Identity usb_identity() const {
    core::usb::Identity usb;
    usb.serial = {identity_.serial[0], identity_.serial[1], identity_.serial[2]};
    return usb;
  }

  [[nodiscard]] bool started() const { return report_.missing == 0U; }

  void note(bool good, Part part) {
    if (!good) {
      report_.miss(part);
    }
  }

  stm32f4::Chip<Word> chip_;
  session::BoardIdentity identity_;
  bool full_speed_;
  hal::StartReport report_{};
  stm32f4::QuadratureEncoders<Word> encoders_;
  stm32f4::PwmMotors<Word> pwm_;
  stm32f4::EnableLine<Word> enable_line_;
  stm32f4::SafetyInputs<Word> safety_inputs_;
  stm32f4::Button<Word> arm_button_;
  stm32f4::Pin<Word> lamp_;
  stm32f4::Ring ring_{};
  stm32f4::SerialPort<Word> port_;
  stm32f4::UsbOtgFs<Word> otg_;
  stm32f4::Watchdog<Word> watchdog_;
  Standstill standstill_;
  Flash record_flash_;
  Flash slot_flash_;
  Store store_;
  SessionPlatform platform_;
  session::TickMailbox mailbox_;
  hal::Panel panel_;
  Motors motors_;
  Ticker ticker_;
  Link link_;
};

}  // namespace tactree::firmware
