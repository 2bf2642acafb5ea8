#pragma once
// Asynchronous file operations of Linux, as far as endpoints of FunctionFS require them.

#include <linux/aio_abi.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::hal::linux_usb {

/// A queue of operations, with a file descriptor that is readable when one has ended.
class AsyncContext {
 public:
  AsyncContext();
  /// Cancels pending operations and waits until they have ended.
  ~AsyncContext();
  AsyncContext(const AsyncContext&) = delete;
  AsyncContext& operator=(const AsyncContext&) = delete;

  [[nodiscard]] int descriptor() const { return event_; }
  /// Starts an operation. `bytes` must stay valid until ended() returns `tag`. Returns false if the
  /// kernel refuses it.
  [[nodiscard]] bool read(int file, std::span<std::byte> bytes, std::uint64_t tag);
  [[nodiscard]] bool write(int file, std::span<const std::byte> bytes, std::uint64_t tag);

  struct Ended {
    std::uint64_t tag = 0;
    std::int64_t result = 0;  ///< bytes, or -errno
  };
  /// Returns the operations that ended since the last call; valid until the next call.
  [[nodiscard]] std::span<const Ended> ended();

 private:
  [[nodiscard]] bool submit(std::uint16_t what, int file, std::span<const std::byte> bytes,
                            std::uint64_t tag);

  /// Maximum number of pending operations; the kernel refuses more. FunctionFsController has at
  /// most 12, four for each endpoint.
  static constexpr unsigned kOperationsMax = 64;

  aio_context_t context_ = 0;
  int event_ = -1;
  std::array<Ended, kOperationsMax> ended_{};
};

}  // namespace tactree::hal::linux_usb
