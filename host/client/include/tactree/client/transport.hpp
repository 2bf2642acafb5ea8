#pragma once
// A byte stream between this computer and a board: a serial port, a pseudo-terminal, USB.
// Bytes may be cut, merged or lost anywhere; core/wire/frame.hpp finds the messages among them.

#include <chrono>
#include <cstddef>
#include <span>
#include <string>

namespace tactree::client {

/// Not for several threads at once, except now().
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// What came in, as much as `bytes` can hold; returns how many. Never waits: 0 when there is
  /// nothing.
  [[nodiscard]] virtual std::size_t read(std::span<std::byte> bytes) = 0;
  /// Hands over as many of `bytes` as there is room for; returns how many. Never waits.
  [[nodiscard]] virtual std::size_t write(std::span<const std::byte> bytes) = 0;
  /// Returns when there is something to read, when the connection is lost, or at the timeout.
  virtual void wait(std::chrono::microseconds timeout) = 0;
  /// Time of this connection since any moment; never decreases. All time limits, heartbeats and
  /// Connection::sleep() use it.
  [[nodiscard]] virtual std::chrono::microseconds now() const;
  /// Whether time passes within wait() only, as in a simulation that waits for this program.
  [[nodiscard]] virtual bool in_lock_step() const { return false; }
  /// False once the other side is gone for good: unplugged, closed. read() and write() then give 0.
  [[nodiscard]] virtual bool connected() const = 0;
  /// For messages to people: "/dev/ttyACM0", "usb 1d50:6159 3-2".
  [[nodiscard]] virtual std::string name() const = 0;
};

}  // namespace tactree::client
