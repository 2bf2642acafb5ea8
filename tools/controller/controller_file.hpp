#pragma once
// What the controller of a Linux board is to do: a JSON file, docs/LINUX-BOARD.md.

#include <cstdint>
#include <filesystem>
#include <string>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/hal/linux/controller_board.hpp"
#include "tactree/support/device_file.hpp"

namespace tactree::controller {

struct RealTimeSettings {
  int priority = 80;      ///< of SCHED_FIFO, 1 .. 98; 0: none is wanted
  bool required = false;  ///< true: refuse to run without priority and locked memory
};

/// Where an application finds it: one of the two.
struct LinkSettings {
  std::string socket;    ///< path of a local one; empty: the USB device port
  std::string usb_port;  ///< of /sys/class/udc; empty: the only one
  std::uint32_t usb_serial = 0;
};

struct ControllerFile {
  std::string file;  ///< where it was read from
  support::Device device;
  std::filesystem::path model;
  core::Configuration configuration{};
  hal::linux_gpio::ControllerBoardSettings board{};
  LinkSettings link{};
  RealTimeSettings real_time{};
};

/// Paths in it are meant from its own folder. Throws support::UserError: "file: place: cause
/// (remedy)".
[[nodiscard]] ControllerFile read_controller_file(const std::filesystem::path& file);

}  // namespace tactree::controller
