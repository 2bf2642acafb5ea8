#pragma once
// Byte transport to an application on another computer, over the USB device port of this computer.
// Offers no DFU, because model and parameters are files of the controller.

#include <cstddef>
#include <span>
#include <string>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/function_fs_controller.hpp"
#include "tactree/hal/usb_device.hpp"

namespace tactree::hal {

/// A BytePort for one thread. Does not allocate after the constructor.
class GadgetPort {
 public:
  /// `udc`: an entry of /sys/class/udc; empty: the only one. Throws std::runtime_error with file,
  /// cause and hint.
  GadgetPort(const core::usb::Identity& identity, const std::string& udc);

  /// Call once per tick: handles requests of the host and reports changes. Cost: some system calls.
  void attend(const core::Status& status, std::uint32_t now_us);
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) noexcept {
    return device_.read(bytes);
  }
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) noexcept {
    return device_.write(bytes);
  }

 private:
  using Storage = core::usb::NoDfuStorage;

  linux_usb::FunctionFsController controller_;
  Storage nothing_;
  UsbDevice<linux_usb::FunctionFsController, Storage, Storage> device_;
};

static_assert(BytePort<GadgetPort>);

}  // namespace tactree::hal
