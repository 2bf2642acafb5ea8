#pragma once
// Serial ports and pseudo-terminals as transports.

#include <memory>
#include <string>
#include <vector>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// What our firmware speaks: firmware/boards/stm32f405.
inline constexpr unsigned kUsualBaud = 1000000;

/// A serial port, or the far end of a pseudo-terminal, in raw mode. `baud`: 9600 .. 4000000, as far
/// as the system knows it; of no meaning where no wire is. Throws LinkError where it cannot be
/// opened.
[[nodiscard]] std::unique_ptr<Transport> open_serial_port(const std::string& path,
                                                          unsigned baud = kUsualBaud);

/// Ports that there are: /dev/ttyACM*, /dev/ttyUSB*.
[[nodiscard]] std::vector<std::string> serial_ports();

/// Our own end of a pseudo-terminal: what a simulated board talks over. Programs open path().
class PseudoTerminal : public Transport {
 public:
  /// Throws LinkError.
  PseudoTerminal();
  ~PseudoTerminal() override;

  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) override;
  void wait(std::chrono::microseconds timeout) override;
  /// Always: programs come and go.
  [[nodiscard]] bool connected() const override { return true; }
  [[nodiscard]] std::string name() const override { return path_; }

 private:
  int ours_ = -1;
  int theirs_ = -1;  // kept open, so that a program that closes it is no hang-up
  std::string path_;
};

}  // namespace tactree::client
