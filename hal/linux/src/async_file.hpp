#pragma once
// Linux's asynchronous file operations, as far as FunctionFS's endpoints need them.

#include <linux/aio_abi.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::hal::linux_usb {

/// Operations under way, and a descriptor that is readable when one has ended.
class AsyncContext {
 public:
  AsyncContext();
  /// Cancels what is under way, and waits for that.
  ~AsyncContext();
  AsyncContext(const AsyncContext&) = delete;
  AsyncContext& operator=(const AsyncContext&) = delete;

  [[nodiscard]] int descriptor() const { return event_; }
  /// False: it was refused. `tag` comes back; `bytes` stay until then.
  [[nodiscard]] bool read(int file, std::span<std::byte> bytes, std::uint64_t tag);
  [[nodiscard]] bool write(int file, std::span<const std::byte> bytes, std::uint64_t tag);

  struct Ended {
    std::uint64_t tag = 0;
    std::int64_t result = 0;  ///< bytes, or -errno
  };
  /// What has ended since the last call; valid until the next one.
  [[nodiscard]] std::span<const Ended> ended();

 private:
  [[nodiscard]] bool submit(std::uint16_t what, int file, std::span<const std::byte> bytes,
                            std::uint64_t tag);

  static constexpr unsigned kOperationsMax = 64;

  aio_context_t context_ = 0;
  int event_ = -1;
  std::array<Ended, kOperationsMax> ended_{};
};

}  // namespace tactree::hal::linux_usb
