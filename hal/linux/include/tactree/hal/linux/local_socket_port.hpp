#pragma once
// Byte transport to an application on the same computer, over a Unix domain socket.

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/file_descriptor.hpp"

namespace tactree::hal {

class SocketError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A BytePort for one application at a time: further connections are closed immediately. The file
/// mode allows owner and group to connect. For one thread.
class LocalSocketPort {
 public:
  /// Throws SocketError if the path is too long, in use by another controller, or not writable.
  explicit LocalSocketPort(std::string path);
  ~LocalSocketPort();
  LocalSocketPort(const LocalSocketPort&) = delete;
  LocalSocketPort& operator=(const LocalSocketPort&) = delete;

  /// Accepts a pending connection, if any. Never blocks. Cost: at most two system calls.
  void accept() noexcept;
  /// read() and write() never block; at most one system call each.
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) noexcept;
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) noexcept;
  [[nodiscard]] bool connected() const { return peer_.get() >= 0; }

 private:
  void note(long result) noexcept;

  std::string path_;
  FileDescriptor listener_;
  FileDescriptor peer_;
};

static_assert(BytePort<LocalSocketPort>);

}  // namespace tactree::hal
