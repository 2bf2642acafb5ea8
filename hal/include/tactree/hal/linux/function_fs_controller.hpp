#pragma once
// The device controller of a Linux computer (a single-board computer with a USB device port),
// through FunctionFS: the kernel answers the standard requests, and hands us the rest. Needs the
// modules libcomposite and usb_f_fs, and root to set it up.
//
// Kernels before 6.12 refuse the descriptor that DFU needs: there the device has the link only, and
// models come over that.

#include <memory>
#include <string>

#include "tactree/hal/usb_device.hpp"

namespace tactree::hal::linux_usb {

/// A USB device port of this computer: one of /sys/class/udc; empty: the only one there is. Throws
/// std::runtime_error: there is none, none of that name, or several.
[[nodiscard]] std::string find_udc(const std::string& name);

/// A UsbController (usb_device.hpp). Not for several threads at once; transfers are asynchronous.
/// Once it is plugged in nothing of it allocates.
class FunctionFsController {
 public:
  /// `udc`: as find_udc() takes it. `with_dfu`: offer model and parameters for DFU, where the
  /// kernel takes that.
  FunctionFsController(const core::usb::Identity& identity, std::string udc, bool with_dfu = true);
  ~FunctionFsController();
  FunctionFsController(const FunctionFsController&) = delete;
  FunctionFsController& operator=(const FunctionFsController&) = delete;

  /// Sets the gadget up and pulls the bus's line up. Throws std::runtime_error with file, cause and
  /// remedy.
  void plug_in();
  void unplug();
  [[nodiscard]] bool plugged_in() const;
  /// Readable when there is something to do; -1 when unplugged.
  [[nodiscard]] int descriptor() const;
  /// Does this kernel take DFU? Known after plug_in().
  [[nodiscard]] bool has_dfu() const;

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
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

static_assert(UsbController<FunctionFsController>);

}  // namespace tactree::hal::linux_usb
