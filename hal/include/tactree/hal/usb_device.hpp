#pragma once
// USB device of a board: passes the host's requests to core/link/usb/, which makes all decisions,
// and transfers bytes. A port implements UsbController. All functions are called from one context.
// Loop and memory annotations: docs/BOUND.md.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/usb/descriptors.hpp"
#include "tactree/core/link/usb/dfu.hpp"
#include "tactree/core/link/usb/setup.hpp"
#include "tactree/core/link/usb/standard_requests.hpp"

namespace tactree::hal {

/// Bus event.
struct UsbEvent {
  enum class Kind : std::uint8_t {
    kNone = 0,
    kReset,         ///< bus reset by the host; `speed` is valid; all endpoints except 0 are closed
    kDisconnected,  ///< cable unplugged, or bus suspended
    kConfigured,    ///< endpoints are open without a request of the host: the controller accepted
                    ///< its configuration itself (Linux), or a suspended bus was resumed
    kUnconfigured,  ///< the controller left the configuration itself (Linux)
    kSetup,         ///< `setup` was received; this ends an older control transfer
    kData,          ///< data stage to the device is complete: see control_data()
  };
  Kind kind = Kind::kNone;
  core::usb::Speed speed = core::usb::Speed::kFull;
  core::usb::SetupPacket setup{};
};

/// USB device controller. All functions return immediately and are called from one context.
///   next_event()              returns the oldest event not yet returned
///   control_send(data, end)   starts the data stage to the host; `end`: terminate it with a short
///                             packet, of length zero if necessary. `data` must stay valid until
///                             the next event
///   control_receive(bytes)    starts the data stage from the host, followed by the event kData
///   control_data()            returns the data of that stage
///   control_acknowledge()     performs the status stage
///   control_stall()           refuses the control transfer by a stall
/// The next three precede the status stage of the request that caused them, because the host may
/// use the endpoints directly after it:
///   set_address(address)      sets the address that is valid after the status stage
///   configure(open)           opens the endpoints with cleared data toggles, or closes them
///   halt(endpoint, on)        stalls the endpoint, or ends the stall and clears the data toggle
///   read(endpoint, bytes)     copies received bytes; returns their number
///   write(endpoint, bytes)    queues bytes; returns their number. An interrupt endpoint accepts a
///                             message completely or not at all
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

/// USB device with link, model and parameter interfaces. As a BytePort (board.hpp) it carries the
/// messages of the link.
template <UsbController Controller, core::usb::DfuStorage Model, core::usb::DfuStorage Parameters>
class UsbDevice {
 public:
  UsbDevice(Controller& controller, const core::usb::Identity& identity, bool has_high_speed,
            Model& model, Parameters& parameters)
      : controller_(controller),
        standard_(identity, has_high_speed),
        model_(model),
        parameters_(parameters) {}

  /// Call once per tick, after the tick's work, or more often between the ticks. Handles at most
  /// kEventsPerTick events, which bounds the cost whatever the host sends.
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
  /// Sends a notice of state, faults and limits to the host. Returns false if it was not queued,
  /// for instance because the preceding notice is pending; call it again then.
  [[nodiscard]] bool send_news(const core::usb::NewsPacket& news) {
    const auto bytes = std::as_bytes(std::span(&news, 1));
    return may_move(core::usb::kNewsIn) &&
           controller_.write(core::usb::kNewsIn, bytes) == bytes.size();
  }

  /// Call once per tick: sends a notice if state or faults have changed since the last notice.
  void send_changes(const core::Status& status) {
    send_changes(core::usb::NewsPacket{status.tick, static_cast<std::uint32_t>(status.state),
                                       status.faults, status.limits});
  }
  void send_changes(const core::usb::NewsPacket& news) {
    const bool same = news.state == last_sent_.state && news.faults == last_sent_.faults;
    if (!same && send_news(news)) {
      last_sent_ = news;
    }
  }

  /// True if a host has selected a configuration.
  [[nodiscard]] bool configured() const { return standard_.configured(); }
  [[nodiscard]] const core::usb::StandardRequests& standard() const { return standard_; }
  [[nodiscard]] const core::usb::Dfu<Model>& model() const { return model_; }
  [[nodiscard]] const core::usb::Dfu<Parameters>& parameters() const { return parameters_; }

 private:
  static constexpr std::uint32_t kEventsPerTick = 4;  // a control transfer has up to two

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
    }
  }

  /// Aborts a transfer in progress.
  void leave() {
    model_.reset();
    parameters_.reset();
  }

  [[nodiscard]] core::usb::ControlResponse judge(const core::usb::SetupPacket& setup) {
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

  [[nodiscard]] core::usb::ControlResponse judge_data() {
    const auto data = controller_.control_data();
    return setup_.wIndex == core::usb::kModelInterface ? model_.data(data) : parameters_.data(data);
  }

  void answer(const core::usb::ControlResponse& answer) {
    using Kind = core::usb::ControlResponse::Kind;
    if (answer.kind == Kind::kSend) {
      controller_.control_send(answer.data, answer.data.size() < setup_.wLength);
    } else if (answer.kind == Kind::kReceive) {
      controller_.control_receive(setup_.wLength);
    } else if (answer.kind == Kind::kAcknowledge) {
      carry_out(answer);
      controller_.control_acknowledge();
    } else {
      controller_.control_stall();
    }
  }

  void carry_out(const core::usb::ControlResponse& answer) {
    using Effect = core::usb::ControlResponse::Effect;
    if (answer.effect == Effect::kTakeAddress) {
      controller_.set_address(answer.value);
    } else if (answer.effect == Effect::kConfigure) {
      controller_.configure(answer.value != 0);
    } else if (answer.effect == Effect::kHalt || answer.effect == Effect::kClearHalt) {
      controller_.halt(answer.value, answer.effect == Effect::kHalt);
    }
  }

  Controller& controller_;
  core::usb::StandardRequests standard_;
  core::usb::Dfu<Model> model_;
  core::usb::Dfu<Parameters> parameters_;
  core::usb::SetupPacket setup_{};
  core::usb::NewsPacket last_sent_{};
};

}  // namespace tactree::hal
