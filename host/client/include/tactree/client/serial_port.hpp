#pragma once
// Serial ports and pseudo-terminals as transports.

#include <memory>
#include <string>
#include <vector>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// Speed of the firmware's serial port: firmware/boards/stm32f405.
inline constexpr unsigned kUsualBaud = 1000000;

/// Opens a serial port, or the far end of a pseudo-terminal, in raw mode. `baud`: a usual speed,
/// 9600 .. 4000000; has no effect on ports without a wire. Throws LinkError for another speed, or
/// if the port cannot be opened.
[[nodiscard]] std::unique_ptr<Transport> open_serial_port(const std::string& path,
                                                          unsigned baud = kUsualBaud);

/// Existing ports /dev/ttyACM* and /dev/ttyUSB*.
[[nodiscard]] std::vector<std::string> serial_ports();

/// The board's end of a pseudo-terminal, for a simulated board. Programs open name().
class PseudoTerminal : public Transport {
 public:
  /// Throws LinkError.
  PseudoTerminal();
  ~PseudoTerminal() override;

  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) override;
  void wait(std::chrono::microseconds timeout) override;
  /// Always true, because a program may connect at any time.
  [[nodiscard]] bool connected() const override { return true; }
  [[nodiscard]] std::string name() const override { return path_; }

 private:
  int ours_ = -1;
  int theirs_ = -1;  // kept open, so a program that closes it causes no hang-up
  std::string path_;
};

}  // namespace tactree::client
