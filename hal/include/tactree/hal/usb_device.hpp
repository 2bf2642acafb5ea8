#pragma once
// The USB device of a board: hands what the host asks to the core, and moves bytes. A port
// implements the contract of its device controller; everything that is decided is in core/usb/.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/controller.hpp"
#include "tactree/core/usb/descriptors.hpp"
#include "tactree/core/usb/dfu.hpp"
#include "tactree/core/usb/setup.hpp"
#include "tactree/core/usb/standard_requests.hpp"

namespace tactree::hal {

/// What happened on the bus.
struct UsbEvent {
  enum class Kind : std::uint8_t {
    kNone = 0,
    kReset,         ///< by the host; `speed` holds from now on. Endpoints but 0 are closed
    kDisconnected,  ///< the cable was pulled, or the bus sleeps
    kConfigured,    ///< the controller took the configuration by itself (Linux); endpoints are open
    kUnconfigured,  ///< and gave it up
    kSetup,         ///< `setup` came in; an older control transfer is over
    kData,          ///< of a control transfer to the device: control_data() holds it
    kStatusDone,    ///< the control transfer is over
  };
  Kind kind = Kind::kNone;
  core::usb::Speed speed = core::usb::Speed::kFull;
  core::usb::SetupPacket setup{};
};

/// A controller of the device's side of the bus. Functions return at once; all are called from one
/// context.
///   next_event()              what happened first of what was not told yet
///   control_send(data, end)   data stage to the host; `end`: a packet shorter than the endpoint's
///                             ends it, if need be an empty one. `data` holds until the next event
///   control_receive(bytes)    data stage from the host, then the event kData
///   control_data()            what came in
///   control_acknowledge()     status stage
///   control_stall()           refuses the control transfer
///   set_address(address)      from now on
///   configure(open)           opens the endpoints with fresh data toggles, or closes them
///   halt(endpoint, on)        stalls it until it is called with false; fresh data toggle then
///   read(endpoint, bytes)     bytes that came in; returns how many
///   write(endpoint, bytes)    bytes to send; returns how many were taken. A message of an
///                             interrupt endpoint is taken whole or not at all
template <class T>
concept UsbController = requires(T& usb, std::span<const std::byte> out, std::span<std::byte> in,
                                 std::uint8_t number, std::uint16_t count, bool on) {
  { usb.next_event() } -> std::same_as<UsbEvent>;
  { usb.control_send(out, on) } -> std::same_as<void>;
  { usb.control_receive(count) } -> std::same_as<void>;
  { usb.control_data() } -> std::same_as<std::span<const std::byte>>;
  { usb.control_acknowledge() } -> std::same_as<void>;
  { usb.control_stall() } -> std::same_as<void>;
  { usb.set_address(number) } -> std::same_as<void>;
  { usb.configure(on) } -> std::same_as<void>;
  { usb.halt(number, on) } -> std::same_as<void>;
  { usb.read(number, in) } -> std::same_as<std::size_t>;
  { usb.write(number, out) } -> std::same_as<std::size_t>;
};

/// Also a BytePort (board.hpp): the messages of the link.
template <UsbController Controller, core::usb::DfuStorage Model, core::usb::DfuStorage Parameters>
class UsbDevice {
 public:
  UsbDevice(Controller& controller, const core::usb::Identity& identity, bool has_high_speed,
            Model& model, Parameters& parameters)
      : controller_(controller),
        standard_(identity, has_high_speed),
        model_(model),
        parameters_(parameters) {}

  /// Once a tick, in the loop's spare time: takes a few events, so that a host that asks without
  /// end costs no tick its deadline.
  void poll(std::uint32_t now_us) {
    model_.advance(now_us);
    parameters_.advance(now_us);
    for (std::uint32_t i = 0; i < kEventsPerTick; ++i) {  // bound: kEventsPerTick
      const UsbEvent event = controller_.next_event();
      if (event.kind == UsbEvent::Kind::kNone) {
        return;
      }
      take(event);
    }
  }

  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) noexcept {
    return may_move(core::usb::kBulkOut) ? controller_.read(core::usb::kBulkOut, bytes) : 0;
  }
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) noexcept {
    return may_move(core::usb::kBulkIn) ? controller_.write(core::usb::kBulkIn, bytes) : 0;
  }
  /// Tells the host that state, faults or limits are others now; false: it has not taken the news
  /// before yet, so try again.
  [[nodiscard]] bool tell(const core::usb::NewsPacket& news) {
    const auto bytes = std::as_bytes(std::span(&news, 1));
    return may_move(core::usb::kNewsIn) &&
           controller_.write(core::usb::kNewsIn, bytes) == bytes.size();
  }

  /// Once a tick: the news, where state or faults are others than the host knows.
  void tell_changes(const core::Status& status) {
    const core::usb::NewsPacket news{status.tick, static_cast<std::uint32_t>(status.state),
                                     status.faults, status.limits};
    const bool same = news.state == told_.state && news.faults == told_.faults;
    if (!same && tell(news)) {
      told_ = news;
    }
  }

  /// There is a host that has chosen a configuration.
  [[nodiscard]] bool configured() const { return standard_.configured(); }
  [[nodiscard]] const core::usb::StandardRequests& standard() const { return standard_; }
  [[nodiscard]] const core::usb::Dfu<Model>& model() const { return model_; }
  [[nodiscard]] const core::usb::Dfu<Parameters>& parameters() const { return parameters_; }

 private:
  static constexpr std::uint32_t kEventsPerTick = 4;

  [[nodiscard]] bool may_move(std::uint8_t endpoint) const {
    return standard_.configured() && !standard_.is_halted(endpoint);
  }

  void take(const UsbEvent& event) {
    using Kind = UsbEvent::Kind;
    if (event.kind == Kind::kReset) {
      leave();
      standard_.reset(event.speed);
    } else if (event.kind == Kind::kDisconnected || event.kind == Kind::kUnconfigured) {
      leave();
      standard_.set_configured(false);
    } else if (event.kind == Kind::kConfigured) {
      standard_.set_configured(true);
    } else if (event.kind == Kind::kSetup) {
      setup_ = event.setup;
      answer(judge(setup_));
    } else if (event.kind == Kind::kData) {
      answer(judge_data());
    } else if (event.kind == Kind::kStatusDone) {
      carry_out();
    }
  }

  /// A transfer that was under way will not go on.
  void leave() {
    pending_ = {};
    model_.reset();
    parameters_.reset();
  }

  [[nodiscard]] core::usb::Answer judge(const core::usb::SetupPacket& setup) {
    if (setup.type() != core::usb::kTypeClass) {
      return standard_.setup(setup);
    }
    if (setup.recipient() != core::usb::kToInterface || !standard_.configured()) {
      return core::usb::stall();
    }
    if (setup.wIndex == core::usb::kModelInterface) {
      return model_.setup(setup);
    }
    return setup.wIndex == core::usb::kParameterInterface ? parameters_.setup(setup)
                                                          : core::usb::stall();
  }

  [[nodiscard]] core::usb::Answer judge_data() {
    const auto data = controller_.control_data();
    return setup_.wIndex == core::usb::kModelInterface ? model_.data(data) : parameters_.data(data);
  }

  void answer(const core::usb::Answer& answer) {
    using Kind = core::usb::Answer::Kind;
    pending_ = answer;
    if (answer.kind == Kind::kSend) {
      controller_.control_send(answer.data, answer.data.size() < setup_.wLength);
    } else if (answer.kind == Kind::kReceive) {
      controller_.control_receive(setup_.wLength);
    } else if (answer.kind == Kind::kAcknowledge) {
      controller_.control_acknowledge();
    } else {
      controller_.control_stall();
    }
  }

  /// An address holds from the end of the request's status stage on, not earlier (9.4.6).
  void carry_out() {
    using Effect = core::usb::Answer::Effect;
    const core::usb::Answer done = pending_;
    pending_ = {};
    if (done.effect == Effect::kTakeAddress) {
      controller_.set_address(done.value);
    } else if (done.effect == Effect::kConfigure) {
      controller_.configure(done.value != 0);
    } else if (done.effect == Effect::kHalt || done.effect == Effect::kClearHalt) {
      controller_.halt(done.value, done.effect == Effect::kHalt);
    }
  }

  Controller& controller_;
  core::usb::StandardRequests standard_;
  core::usb::Dfu<Model> model_;
  core::usb::Dfu<Parameters> parameters_;
  core::usb::SetupPacket setup_{};
  core::usb::Answer pending_{};
  core::usb::NewsPacket told_{};
};

}  // namespace tactree::hal
