#pragma once
// Byte transport over USB. Transfers are always pending, so read() and write() never wait.

#include <memory>
#include <optional>
#include <string>

#include "tactree/client/transport.hpp"
#include "tactree/client/usb_devices.hpp"
#include "tactree/core/link/usb/descriptors.hpp"

namespace tactree::client {

class UsbTransport : public Transport {
 public:
  /// Opens the board and claims its link, which takes some milliseconds. Throws LinkError with
  /// cause and hint if the board is gone, permission is missing or another program uses the
  /// board.
  explicit UsbTransport(const UsbDeviceInfo& device);
  ~UsbTransport() override;

  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) override;
  void wait(std::chrono::microseconds timeout) override;
  [[nodiscard]] bool connected() const override;
  [[nodiscard]] std::string name() const override;

  /// The newest notice of state and faults since the last call; empty if there was none.
  [[nodiscard]] std::optional<core::usb::NewsPacket> take_news();
  /// Reason for the loss of the connection; empty while connected.
  [[nodiscard]] std::string reason() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Opens the board selected by `which`: a serial number, a path ("3-1.2"), or empty if there is
/// only one board. Throws LinkError, which lists the boards.
[[nodiscard]] std::unique_ptr<UsbTransport> open_usb(const std::string& which);

}  // namespace tactree::client
