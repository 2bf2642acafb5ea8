#pragma once
// A device controller without a cable: Linux's virtual host controller (module vhci-hcd) at the
// other end of a socket, USB/IP between the two (Linux, Documentation/usb/usbip_protocol.rst). So a
// simulated board is a USB device of this computer, which any program finds there.

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactree/hal/usb_device.hpp"

namespace tactree::hal::linux_usb {

/// A UsbController (usb_device.hpp). Not for several threads at once.
class UsbIpController {
 public:
  UsbIpController();
  ~UsbIpController();
  UsbIpController(const UsbIpController&) = delete;
  UsbIpController& operator=(const UsbIpController&) = delete;

  /// Plugs the device into a free port of this computer. Throws std::runtime_error with cause and
  /// remedy: no vhci-hcd, no permission, no free port.
  void plug_in();
  /// Plugs it into whatever speaks USB/IP at the other end of `socket`, which is owned from now on.
  void plug_into(int socket);
  /// Pulls the cable.
  void unplug();
  [[nodiscard]] bool plugged_in() const;
  /// Readable when something came in; -1 when unplugged.
  [[nodiscard]] int descriptor() const;

  [[nodiscard]] UsbEvent next_event();
  void control_send(std::span<const std::byte> data, bool end);
  void control_receive(std::uint16_t bytes);
  [[nodiscard]] std::span<const std::byte> control_data() const;
  void control_acknowledge();
  void control_stall();
  void set_address(std::uint8_t address);
  void configure(bool open);
  void halt(std::uint8_t endpoint, bool on);
  [[nodiscard]] std::size_t read(std::uint8_t endpoint, std::span<std::byte> bytes);
  [[nodiscard]] std::size_t write(std::uint8_t endpoint, std::span<const std::byte> bytes);

 private:
  struct Transfer;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

static_assert(UsbController<UsbIpController>);

}  // namespace tactree::hal::linux_usb
