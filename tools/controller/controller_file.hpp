#pragma once
// Settings of the controller of a Linux board, from a JSON file (docs/LINUX-BOARD.md).

#include <cstdint>
#include <filesystem>
#include <string>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/hal/linux/controller_board.hpp"
#include "tactree/support/device_file.hpp"

namespace tactree::controller {

struct RealTimeSettings {
  int priority = 80;      ///< of SCHED_FIFO, 1 .. 98; 0: no real-time scheduling
  bool required = false;  ///< true: refuse to run without priority and locked memory
};

/// Link for applications: a local socket or a USB device port.
struct LinkSettings {
  std::string socket;    ///< path of the socket; empty: the USB device port is used
  std::string usb_port;  ///< name in /sys/class/udc; empty: the only one
  std::uint32_t usb_serial = 0;
};

struct ControllerFile {
  std::string file;  ///< path of the file itself
  support::Device device;
  std::filesystem::path model;
  core::Configuration configuration{};
  hal::linux_gpio::ControllerBoardSettings board{};
  LinkSettings link{};
  RealTimeSettings real_time{};
};

/// Paths in the file are relative to its folder. Throws support::UserError with the text "file:
/// location: cause (hint)".
[[nodiscard]] ControllerFile read_controller_file(const std::filesystem::path& file);

}  // namespace tactree::controller
