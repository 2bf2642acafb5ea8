#pragma once
// The standard requests of endpoint 0 (USB 2.0, section 9.4), and the vendor request for the
// Microsoft descriptors. Requests that violate the standard are refused with a stall.
//
// Interrupt safety: no shared state; one context owns an object. Cost: constant.

#include "tactree/core/link/usb/descriptors.hpp"
#include "tactree/core/link/usb/setup.hpp"

namespace tactree::core::usb {

class StandardRequests {
 public:
  /// `has_high_speed`: the controller can run at either speed.
  StandardRequests(const Identity& identity, bool has_high_speed)
      : identity_(identity), has_high_speed_(has_high_speed) {}

  /// Call after a bus reset, with the negotiated speed.
  void reset(Speed speed);
  /// For a controller that handles SET_CONFIGURATION itself, such as that of Linux.
  void set_configured(bool configured);

  /// Handles a standard or vendor request. The effect of the response is already applied to the
  /// state of this object.
  [[nodiscard]] ControlResponse setup(const SetupPacket& setup);

  [[nodiscard]] bool configured() const { return configured_; }
  [[nodiscard]] Speed speed() const { return speed_; }
  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] bool is_halted(std::uint8_t endpoint) const;

 private:
  [[nodiscard]] ControlResponse of_device(const SetupPacket& setup);
  [[nodiscard]] ControlResponse of_interface(const SetupPacket& setup);
  [[nodiscard]] ControlResponse of_endpoint(const SetupPacket& setup);
  [[nodiscard]] ControlResponse take_address(const SetupPacket& setup);
  [[nodiscard]] ControlResponse take_configuration(const SetupPacket& setup);
  [[nodiscard]] ControlResponse take_halt(const SetupPacket& setup);
  [[nodiscard]] ControlResponse descriptor(const SetupPacket& setup);
  [[nodiscard]] ControlResponse configuration(const SetupPacket& setup, Speed speed,
                                              std::uint8_t type);
  [[nodiscard]] ControlResponse status(const SetupPacket& setup, std::uint8_t value);
  [[nodiscard]] ControlResponse send_byte(const SetupPacket& setup, std::uint8_t value);

  Identity identity_;
  bool has_high_speed_;
  Speed speed_ = Speed::kFull;
  std::uint8_t address_ = 0;
  bool configured_ = false;
  std::uint32_t halted_ = 0;  // bit n: entry n of kEndpoints
  std::array<std::byte, kConfigurationBytes> buffer_{};
};

}  // namespace tactree::core::usb
