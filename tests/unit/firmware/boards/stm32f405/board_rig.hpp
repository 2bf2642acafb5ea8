#pragma once
// The board of firmware/boards/stm32f405 on the faked chip, and an application's client at the
// other end of its serial port or, while the cable is plugged in, of USB, in steps of a tick.
// Between two ticks the board serves the application, as serve() does, and bytes take their time on
// the wire.

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "await_response.hpp"
#include "boards/stm32f405/stm32f405_board.hpp"
#include "fake_chip.hpp"
#include "fake_hand.hpp"
#include "tactree/client/client.hpp"
#include "tactree/hal/loop.hpp"
#include "usb_host.hpp"

namespace tactree::test {

/// Functions and symbols that an image gets from core and linker script, for the chip in use.
struct ChipInUse {
  FakeChip* chip = nullptr;
  bool ticks_held = false;
  std::function<void()> on_hold = [] {};
};
inline ChipInUse chip_in_use;

class BoardRig {
 public:
  using Board = firmware::Stm32f405Board<FakeWord, FakeCell>;
  static constexpr std::uint32_t kBlobBegin = 0x20000;  ///< in the flash; memory.ld

  BoardRig() { chip_in_use = {&chip()}; }
  ~BoardRig() { chip_in_use = {}; }
  BoardRig(const BoardRig&) = delete;

  /// As `tactree image` lays it out.
  void program_image_model(std::span<const std::byte> blob) { chip().flash.put(kBlobBegin, blob); }

  /// From reset to the first tick, as main.cpp does it.
  void boot(const hal::CapturedFault& last_fault = {}) {
    const auto clocks = firmware::prepare_chip(chip().chip());
    board_ = std::make_unique<Board>(chip().chip(), chip().flash.whole(), clocks, kIdentity);
    configuration_ = board_->connect(last_fault);
    if (link_use != firmware::wiring::kLinkUse || signs_proven != firmware::wiring::kSignsProven) {
      // As connect() returns it with other constants in wiring.hpp.
      configuration_ = firmware::wiring::configuration(link_use, signs_proven);
      store::apply_saved_parameters(board_->storage().parameters(), configuration_);
    }
    chip().flash.pass = [this](double us) { pass_us(us); };
    chip().serial.give_ring(&board_->ring());  // an address in M0AR has too few bits for the host's
    controller_ = std::make_unique<core::Controller>();
    loop_.emplace(*board_, *controller_);
    start_.image = image;
    if (image == hal::ImageStatus::kOk) {
      start_ = loop_->start(configuration_);
    }
    board_->report(start_);
    served_ = std::make_unique<Board::Application>(*board_, *controller_);
    served_->started(start_, configuration_);
  }

  /// Power cycle; the flash keeps its content.
  void restart() {
    const std::vector<std::uint32_t> kept = chip().flash.content();
    loop_.reset();
    served_.reset();
    board_.reset();
    usb_.reset();
    chip_ = std::make_unique<FakeChip>();
    chip_in_use = {chip_.get()};
    chip_->flash.restore(kept);
    client_ = client::Client();
    to_board_.clear();
    boot();
  }

  /// Advances the time to the next tick and runs it.
  const core::Status& tick() {
    const std::uint32_t before = ticks_;
    while (ticks_ == before) {
      served_->work();
      if (!to_board_.empty()) {
        chip().serial.arrive(to_board_.front());
        to_board_.pop_front();
      }
      pass_us(10);
    }
    if (application_runs) {
      talk();
    }
    return status_;
  }
  const core::Status& run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      tick();
    }
    return status_;
  }

  // ---- the application

  client::Response await(std::uint16_t sequence, int ticks_max = 5000) {
    int ticks = 0;
    return test::await_response(
        client_, sequence, [&] { return ticks++ < ticks_max; }, [&] { tick(); });
  }
  client::Response ask(core::wire::MessageKind kind, std::span<const std::byte> payload = {}) {
    return await(client_.send(kind, payload, now_us()));
  }
  template <core::wire::Message T>
  client::Response ask(core::wire::MessageKind kind, const T& message) {
    return ask(kind, std::as_bytes(std::span(&message, 1)));
  }
  client::Response open(std::uint16_t link_timeout_ms = 50) {
    return await(client_.open(link_timeout_ms, 7, now_us()));
  }
  client::Response control(core::wire::ControlCode code) {
    return ask(core::wire::MessageKind::kControl,
               core::wire::ControlRequest{static_cast<std::uint8_t>(code), {}, 0});
  }
  core::wire::ReadStartReply ask_start() {
    core::wire::ReadStartReply reply;
    reply.missing = 0xFFFFFFFFU;
    (void)ask(core::wire::MessageKind::kReadStart).read(reply);
    return reply;
  }
  /// Homed, armed, and the hand at the dead-man control: to active.
  bool arm() {
    const bool armed = open().ok() && control(core::wire::ControlCode::kHome).ok() &&
                       control(core::wire::ControlCode::kArm).ok();
    run(20);
    chip().hold_dead_man(true);
    run(500);
    return armed && status_.state == core::State::kActive;
  }
  /// A model as `tactree flash` writes it. The first response that is not good, or the last.
  client::Response flash(std::span<const std::byte> model) {
    using Kind = core::wire::MessageKind;
    core::wire::BeginModelRequest begin;
    begin.bytes = static_cast<std::uint32_t>(model.size());
    begin.checksum = core::crc32(model);
    client::Response response = ask(Kind::kBeginModel, begin);
    for (std::size_t at = 0; response.ok() && at < model.size(); at += core::wire::kMaxPiece) {
      const auto piece =
          model.subspan(at, std::min<std::size_t>(core::wire::kMaxPiece, model.size() - at));
      const core::wire::WriteModelRequest where{static_cast<std::uint32_t>(at)};
      const auto head = std::as_bytes(std::span(&where, 1));
      std::vector<std::byte> payload(head.begin(), head.end());
      payload.insert(payload.end(), piece.begin(), piece.end());
      response = ask(Kind::kWriteModel, payload);
    }
    if (response.ok()) {
      response = ask(Kind::kFinishModel, core::wire::FinishModelRequest{});
    }
    core::wire::FinishModelReply finished;
    if (!response.ok() || !response.read(finished)) {
      return response;
    }
    return ask(Kind::kActivateModel, core::wire::SlotRequest{finished.slot});
  }

  // ---- USB

  /// Plugs the cable in. A host enumerates the board and opens its link, which the application uses
  /// from then on, unless it `stays` at the serial port. Returns false if a request fails.
  bool plug_usb(bool stays = false) {
    usb_.emplace(chip().usb);
    chip().usb.suspend(false);
    usb_->begin_reset();
    run(10);
    usb_->end_reset();
    run(10);
    bool good = usb_request({0x00, core::usb::kSetAddress, 5, 0, 0});
    usb_->address = 5;
    good = usb_request({0x00, core::usb::kSetConfiguration, 1, 0, 0}) && good;
    good = usb_request({0x01, core::usb::kSetInterface, 0, core::usb::kLinkInterface, 0}) && good;
    over_usb_ = good && !stays;
    return good;
  }
  void unplug_usb() {
    usb_.reset();
    over_usb_ = false;
    chip().usb.suspend(true);
  }
  bool usb_request(const core::usb::SetupPacket& setup, const UsbBytes& data = {},
                   int ticks_max = 5000) {
    usb_->submit(setup, data);
    for (int i = 0; i < ticks_max && usb_->result() == UsbHost::Result::kPending; ++i) {
      tick();
    }
    return usb_->result() == UsbHost::Result::kDone;
  }
  [[nodiscard]] UsbHost& usb() { return *usb_; }

  /// Bytes between the application and the wire: for a client that is not ours.
  std::deque<std::uint8_t>& to_board() { return to_board_; }
  std::vector<std::uint8_t> take_sent() { return std::exchange(chip().serial.sent, {}); }

  [[nodiscard]] client::Client& client() { return client_; }
  [[nodiscard]] FakeChip& chip() { return *chip_; }
  [[nodiscard]] Board& board() { return *board_; }
  [[nodiscard]] core::Controller& controller() { return *controller_; }
  [[nodiscard]] const hal::StartResult& started() const { return start_; }
  [[nodiscard]] const core::Configuration& configuration() const { return configuration_; }
  [[nodiscard]] const core::Status& status() const { return status_; }
  [[nodiscard]] client::Microseconds now_us() { return 1000U * std::uint64_t{chip().ticks}; }
  /// Share of the time that the motors get current.
  [[nodiscard]] double duty() {
    return chip().tim8.duty(0) + chip().tim8.duty(1) + chip().tim8.duty(2);
  }

  /// N at the probe, of the efforts that the pins of the motors show. The device is at rest.
  [[nodiscard]] core::Vec3 force_at_pins() {
    float efforts[core::kAxes];
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      const auto share = static_cast<float>(chip().tim8.duty(axis));
      efforts[axis] = (chip().gpio_c.level(axis) ? -1.0F : 1.0F) * share *
                      firmware::wiring::kEffortAtFullWidth[axis];
    }
    return core::transposed_times(core::force_per_effort(hand_.pose().effort_per_force),
                                  {efforts[0], efforts[1], efforts[2]});
  }

  /// Presses the button for this long, and releases it.
  void press_button(int ticks) {
    chip().press_button(true);
    run(ticks);
    chip().press_button(false);
    run(50);
  }
  /// The hand presses on sheet_below_hand(), and stays there; true if it feels it.
  bool touch() {
    hand_.move(chip(), kOnSheetBelowHand, [this] { tick(); });
    run(300);
    return feels();
  }
  /// The hand returns to the home of the device, in free space.
  void lift() {
    hand_.move(chip(), {}, [this] { tick(); });
  }
  /// True if the motors press the hand back.
  [[nodiscard]] bool feels() {
    return status_.rendering.in_contact && status_.force.z > 0.0F && duty() > 0.0;
  }

  /// Homed and armed by the button, the hand at the dead-man control: to active.
  bool arm_by_button() {
    press_button(1100);
    press_button(1100);
    chip().hold_dead_man(true);
    run(500);
    return status_.state == core::State::kActive;
  }

  firmware::wiring::LinkUse link_use = firmware::wiring::kLinkUse;
  bool signs_proven = true;
  hal::ImageStatus image = hal::ImageStatus::kOk;  ///< of the self-test
  bool application_runs = true;
  bool ticks_run = true;
  std::uint64_t usb_accesses_of_ticks = 0;  ///< of the USB core; a tick has none

  /// Runs a tick as an interrupt. While ticks are held, due ticks are merged into one.
  void pass_us(double us) {
    chip().pass_us(us);
    if (usb_.has_value()) {
      for (token_due_us_ += us; token_due_us_ >= kTokenUs; token_due_us_ -= kTokenUs) {
        (void)usb_->step();
      }
    }
    since_tick_us_ += us;
    if (since_tick_us_ < 1000.0 || chip_in_use.ticks_held) {
      return;
    }
    since_tick_us_ = 0.0;
    ++ticks_;
    chip().begin_tick();
    if (ticks_run) {
      const std::uint64_t accesses = chip().usb.accesses;
      status_ = loop_->tick().status;
      usb_accesses_of_ticks += chip().usb.accesses - accesses;
    }
  }

 private:
  static constexpr double kTokenUs = 50.0;  // 64 bytes at 12 Mbit/s
  static constexpr session::BoardIdentity kIdentity{"stm32f405", "1.2.3", {}, 168000000};

  void talk() {
    const std::vector<std::uint8_t> sent = over_usb_ ? usb_->take_read() : take_sent();
    client_.receive(std::as_bytes(std::span(sent)), now_us());
    client_.advance(now_us());
    std::vector<std::uint8_t> bytes;
    for (const std::byte byte : client_.to_send()) {
      bytes.push_back(static_cast<std::uint8_t>(byte));
    }
    if (over_usb_) {
      usb_->write(bytes);
    } else {
      to_board_.insert(to_board_.end(), bytes.begin(), bytes.end());
    }
    client_.sent(bytes.size());
  }

  std::unique_ptr<FakeChip> chip_ = std::make_unique<FakeChip>();
  FakeHand hand_{firmware::wiring::configuration().device};
  std::unique_ptr<Board> board_;
  std::unique_ptr<core::Controller> controller_;
  std::optional<hal::Loop<Board>> loop_;
  std::unique_ptr<Board::Application> served_;
  core::Configuration configuration_;
  hal::StartResult start_;
  core::Status status_;
  double since_tick_us_ = 0.0;
  std::uint32_t ticks_ = 0;
  client::Client client_;
  std::deque<std::uint8_t> to_board_;
  std::optional<UsbHost> usb_;
  double token_due_us_ = 0.0;
  bool over_usb_ = false;
};

}  // namespace tactree::test
