#pragma once
// Which boards are plugged in. A board is known by its link interface (core/usb/descriptors.hpp),
// not by vendor and product: those are the maker's.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tactree::client {

struct UsbDeviceInfo {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string path;    ///< bus and port numbers: "3-1.2"; the same after a replug there
  std::string serial;  ///< empty: it could not be read
  std::string maker;
  std::string name;
  std::string problem;  ///< why it cannot be opened, with a remedy; empty: it can

  /// "usb 1209:0001 3-1.2"
  [[nodiscard]] std::string label() const;
  friend bool operator==(const UsbDeviceInfo&, const UsbDeviceInfo&) = default;
};

/// Paths of the boards there are now. Opens nothing; empty also where USB cannot be used.
[[nodiscard]] std::vector<std::string> usb_paths();

/// All boards there are now, by path. Opens each for a moment; takes some ms. Throws
/// LinkError when USB cannot be used at all.
[[nodiscard]] std::vector<UsbDeviceInfo> list_usb_devices();

/// Reports boards that are plugged in and unplugged: at once by udev events, and by polling, for
/// systems without udev.
class UsbWatch {
 public:
  using Clock = std::chrono::steady_clock;
  struct Change {
    bool arrived = false;  ///< else it is gone
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

/// The rule that lets the person at the screen, and the group plugdev, open boards.
[[nodiscard]] std::string udev_rule();
/// Writes it below `root` ("/"), and returns the file. Throws LinkError with a remedy.
std::string install_udev_rule(const std::string& root = "/");

}  // namespace tactree::client
