#pragma once
// Common interface of the USB device controllers on a Linux computer.

#include "tactree/hal/usb_device.hpp"

namespace tactree::hal::linux_usb {

/// A UsbController (usb_device.hpp) that can be connected and disconnected. For one thread at a
/// time.
class UsbPort {
 public:
  UsbPort() = default;
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;
  virtual ~UsbPort() = default;

  /// Connects the device to the bus. Throws std::runtime_error with cause and hint.
  virtual void plug_in() = 0;
  virtual void unplug() = 0;
  [[nodiscard]] virtual bool plugged_in() const = 0;
  /// File descriptor that is readable while an event is pending; -1 while unplugged.
  [[nodiscard]] virtual int descriptor() const = 0;

  [[nodiscard]] virtual UsbEvent next_event() = 0;
  virtual void control_send(std::span<const std::byte> data, bool end) = 0;
  virtual void control_receive(std::uint16_t bytes) = 0;
  [[nodiscard]] virtual std::span<const std::byte> control_data() const = 0;
  virtual void control_acknowledge() = 0;
  virtual void control_stall() = 0;
  [[nodiscard]] virtual std::size_t read(std::uint8_t endpoint, std::span<std::byte> bytes) = 0;
  [[nodiscard]] virtual std::size_t write(std::uint8_t endpoint,
                                          std::span<const std::byte> bytes) = 0;

  // On some ports the kernel performs the following itself.
  virtual void set_address(std::uint8_t) {}
  virtual void configure(bool) {}
  virtual void halt(std::uint8_t, bool) {}
};

static_assert(UsbController<UsbPort>);

}  // namespace tactree::hal::linux_usb
