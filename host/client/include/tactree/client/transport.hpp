#pragma once
// A byte stream between this computer and a board: a serial port, a pseudo-terminal, USB. Bytes may
// be split, merged or lost anywhere; core/link/wire/frame.hpp finds the messages among them.

#include <chrono>
#include <cstddef>
#include <span>
#include <string>

namespace tactree::client {

/// For one thread at a time, except now().
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Copies as many received bytes as fit and returns their number; 0 if there are none. Never
  /// waits.
  [[nodiscard]] virtual std::size_t read(std::span<std::byte> bytes) = 0;
  /// Accepts as many of `bytes` as there is room for and returns their number. Never waits.
  [[nodiscard]] virtual std::size_t write(std::span<const std::byte> bytes) = 0;
  /// Returns when there are bytes to read, when the connection is lost, or at the timeout.
  virtual void wait(std::chrono::microseconds timeout) = 0;
  /// Time of this connection since an arbitrary start; never decreases. All time limits, heartbeats
  /// and Connection::sleep() use it.
  [[nodiscard]] virtual std::chrono::microseconds now() const;
  /// True if time passes only within wait(), as in a simulation that waits for this program.
  [[nodiscard]] virtual bool in_lock_step() const { return false; }
  /// Returns false once the other side is permanently gone: unplugged, closed. read() and write()
  /// then return 0.
  [[nodiscard]] virtual bool connected() const = 0;
  /// Name shown to the user, e.g. "/dev/ttyACM0" or "usb 1d50:6159 3-2".
  [[nodiscard]] virtual std::string name() const = 0;
};

}  // namespace tactree::client
