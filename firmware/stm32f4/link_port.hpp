#pragma once
// The port of a session on a board with two of them: USB from the first byte that an application
// sends there until the cable is unplugged, the serial port otherwise. A cable that only supplies
// power or transfers models does not disturb an application at the serial port.

#include <cstddef>
#include <span>

namespace tactree::firmware::stm32f4 {

/// `Usb` is a hal::UsbDevice, `Serial` a SerialPort. A hal::BytePort. Call from one context only,
/// outside the tick. Cost: that of the port in use.
template <class Usb, class Serial>
class LinkPort {
 public:
  LinkPort(Usb& usb, Serial& serial) : usb_(usb), serial_(serial) {}

  std::size_t read(std::span<std::byte> bytes) noexcept {
    const std::size_t count = usb_.read(bytes);
    over_usb_ = usb_.configured() && (over_usb_ || count != 0U);
    if (!over_usb_) {
      return serial_.read(bytes);
    }
    serial_.discard();
    return count;
  }
  std::size_t write(std::span<const std::byte> bytes) noexcept {
    return over_usb_ ? usb_.write(bytes) : serial_.write(bytes);
  }

 private:
  Usb& usb_;
  Serial& serial_;
  bool over_usb_ = false;
};

}  // namespace tactree::firmware::stm32f4
