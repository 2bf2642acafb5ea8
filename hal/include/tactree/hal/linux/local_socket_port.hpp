#pragma once
// Bytes to and from an application on the same computer: a socket in the file system.

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

/// A BytePort. One application at a time: another one's connection is closed at once. Who may write
/// to the file may connect: it is for its owner and its group.
class LocalSocketPort {
 public:
  /// Throws SocketError: the path is too long, in use by another controller, or not to be written.
  explicit LocalSocketPort(std::string path);
  ~LocalSocketPort();
  LocalSocketPort(const LocalSocketPort&) = delete;
  LocalSocketPort& operator=(const LocalSocketPort&) = delete;

  /// Takes an application that waits, if one does. Cost: a system call or two.
  void accept() noexcept;
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
