#pragma once
// The USB device controller of a Linux computer with a USB device port, through FunctionFS. The
// kernel handles the standard requests, this class the others. Requires the kernel modules
// libcomposite and usb_f_fs, and root privileges for the setup.
//
// Kernels before 6.12 refuse the DFU descriptor: the device then has only the link, which can also
// transfer models.

#include <memory>
#include <string>

#include "tactree/hal/linux/usb_port.hpp"

namespace tactree::hal::linux_usb {

/// Finds a USB device port of this computer, an entry of /sys/class/udc. An empty name selects the
/// only port. Throws std::runtime_error if it is missing or ambiguous.
[[nodiscard]] std::string find_udc(const std::string& name);

/// Transfers are asynchronous. Does not allocate while plugged in.
class FunctionFsController : public UsbPort {
 public:
  /// `udc`: name for find_udc(). `with_dfu`: offer model and parameters over DFU if the kernel
  /// supports it.
  FunctionFsController(const core::usb::Identity& identity, std::string udc, bool with_dfu = true);
  ~FunctionFsController() override;

  /// Creates the gadget and connects it. Throws std::runtime_error with file, cause and hint.
  void plug_in() override;
  void unplug() override;
  [[nodiscard]] bool plugged_in() const override;
  [[nodiscard]] int descriptor() const override;

  [[nodiscard]] UsbEvent next_event() override;
  void control_send(std::span<const std::byte> data, bool end) override;
  void control_receive(std::uint16_t bytes) override;
  [[nodiscard]] std::span<const std::byte> control_data() const override;
  void control_acknowledge() override;
  void control_stall() override;
  [[nodiscard]] std::size_t read(std::uint8_t endpoint, std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::uint8_t endpoint, std::span<const std::byte> bytes) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactree::hal::linux_usb
