#pragma once
// Bytes over USB. Transfers are always pending: no call waits.

#include <memory>
#include <optional>
#include <string>

#include "tactree/client/transport.hpp"
#include "tactree/client/usb_devices.hpp"
#include "tactree/core/link/usb/descriptors.hpp"

namespace tactree::client {

class UsbTransport : public Transport {
 public:
  /// Opens the board and its link. Takes some ms, once. Throws LinkError with cause and
  /// remedy: gone, no permission, in use by another program.
  explicit UsbTransport(const UsbDeviceInfo& device);
  ~UsbTransport() override;

  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) override;
  void wait(std::chrono::microseconds timeout) override;
  [[nodiscard]] bool connected() const override;
  [[nodiscard]] std::string name() const override;

  /// The last unsolicited notification of state and faults; empty: none since the last call.
  [[nodiscard]] std::optional<core::usb::NewsPacket> take_news();
  /// Why the connection was lost; empty while it is there.
  [[nodiscard]] std::string reason() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Opens the board that `which` names: a serial number, a path ("3-1.2"), or empty where there is
/// just one. Throws LinkError that lists what there is.
[[nodiscard]] std::unique_ptr<UsbTransport> open_usb(const std::string& which);

}  // namespace tactree::client
