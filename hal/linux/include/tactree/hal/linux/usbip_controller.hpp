#pragma once
// A virtual USB device controller. It uses USB/IP over a socket to the virtual host controller of
// Linux, module vhci-hcd (Linux, Documentation/usb/usbip_protocol.rst). A simulated board then
// appears as a USB device of this computer.

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactree/hal/linux/usb_port.hpp"

namespace tactree::hal::linux_usb {

class UsbIpController : public UsbPort {
 public:
  UsbIpController();
  ~UsbIpController() override;

  /// Connects to a free port of this computer. Throws std::runtime_error if vhci-hcd, permission or
  /// a free port is missing.
  void plug_in() override;
  /// Connects the device to the USB/IP host at the other end of `socket`; takes ownership of it.
  void plug_into(int socket);
  void unplug() override;
  [[nodiscard]] bool plugged_in() const override;
  [[nodiscard]] int descriptor() const override;

  void configure(bool open) override;
  void halt(std::uint8_t endpoint, bool on) override;
  [[nodiscard]] UsbEvent next_event() override;
  void control_send(std::span<const std::byte> data, bool end) override;
  void control_receive(std::uint16_t bytes) override;
  [[nodiscard]] std::span<const std::byte> control_data() const override;
  void control_acknowledge() override;
  void control_stall() override;
  [[nodiscard]] std::size_t read(std::uint8_t endpoint, std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::uint8_t endpoint, std::span<const std::byte> bytes) override;

 private:
  struct Transfer;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactree::hal::linux_usb
