#pragma once
// Lists the boards that are plugged in. A board is recognised by its link interface
// (core/link/usb/descriptors.hpp), not by vendor and product, which depend on its maker.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tactree::client {

struct UsbDeviceInfo {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string path;    ///< bus and port numbers: "3-1.2"; the same after a replug into that port
  std::string serial;  ///< empty if it could not be read
  std::string maker;
  std::string name;
  std::string problem;  ///< cause and hint if it cannot be opened; empty otherwise

  /// E.g. "usb 1209:0001 3-1.2".
  [[nodiscard]] std::string label() const;
  friend bool operator==(const UsbDeviceInfo&, const UsbDeviceInfo&) = default;
};

/// Paths of all boards that are plugged in. Opens none. Also empty if USB cannot be used.
[[nodiscard]] std::vector<std::string> usb_paths();

/// All boards that are plugged in, sorted by path. Opens each of them briefly, which takes some
/// milliseconds. Throws LinkError if USB cannot be used.
[[nodiscard]] std::vector<UsbDeviceInfo> list_usb_devices();

/// Reports boards that are plugged in and unplugged: immediately by udev events, and by polling for
/// systems without udev.
class UsbWatch {
 public:
  using Clock = std::chrono::steady_clock;
  struct Change {
    bool arrived = false;  ///< true: plugged in; false: unplugged
    UsbDeviceInfo device;
  };

  explicit UsbWatch(std::chrono::milliseconds look_every = std::chrono::milliseconds(500));
  ~UsbWatch();
  UsbWatch(const UsbWatch&) = delete;
  UsbWatch& operator=(const UsbWatch&) = delete;

  /// Changes since the last call; the first call reports all boards as plugged in.
  [[nodiscard]] std::vector<Change> poll(Clock::time_point now = Clock::now());
  [[nodiscard]] const std::vector<UsbDeviceInfo>& devices() const { return known_; }

 private:
  struct Hotplug;
  std::unique_ptr<Hotplug> hotplug_;
  std::chrono::milliseconds look_every_;
  Clock::time_point next_look_{};
  std::vector<UsbDeviceInfo> known_;
};

/// The udev rule that allows the user logged in locally, and the group plugdev, to open boards.
[[nodiscard]] std::string udev_rule();
/// Writes the rule below `root` and returns the path of the file. Throws LinkError with a hint.
std::string install_udev_rule(const std::string& root = "/");

}  // namespace tactree::client
