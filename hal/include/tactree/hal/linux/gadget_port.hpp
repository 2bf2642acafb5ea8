#pragma once
// Bytes to and from an application on another computer: the link of a board at this computer's own
// USB device port. Model and parameters are not offered for DFU: they are the controller's file.

#include <cstddef>
#include <span>
#include <string>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/function_fs_controller.hpp"
#include "tactree/hal/usb_device.hpp"

namespace tactree::hal {

/// A BytePort. Nothing of it allocates after the constructor.
class GadgetPort {
 public:
  /// `udc`: one of /sys/class/udc; empty: the only one there is. Throws std::runtime_error with
  /// file, cause and remedy.
  GadgetPort(const core::usb::Identity& identity, const std::string& udc);

  /// Once a tick: answers the host, and tells it what has changed. Cost: some system calls.
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
