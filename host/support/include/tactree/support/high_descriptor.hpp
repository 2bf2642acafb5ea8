#pragma once
// Owned file descriptors, and pipes. Every descriptor is close-on-exec, so a child process receives
// only those that are passed to ChildProcess.

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace tactree::support {

/// Throws std::system_error for errno. Its text is "what: cause".
[[noreturn]] inline void fail_with_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

class HighDescriptor {
 public:
  /// Lowest number of an owned descriptor. A child process may receive descriptors below it.
  static constexpr int kMinNumber = 10;

  HighDescriptor() = default;
  /// Takes ownership of `descriptor` and moves it to a number >= kMinNumber. Throws
  /// std::system_error for errno if `descriptor` is negative, because the call that returned it
  /// failed, or if no number is free.
  explicit HighDescriptor(int descriptor) {
    if (descriptor < 0) {
      fail_with_errno("file descriptor");
    }
    descriptor_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, kMinNumber);
    const int cause = errno;
    ::close(descriptor);
    if (descriptor_ < 0) {
      errno = cause;
      fail_with_errno("file descriptor");
    }
  }
  HighDescriptor(HighDescriptor&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)) {}
  HighDescriptor& operator=(HighDescriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  HighDescriptor(const HighDescriptor&) = delete;
  HighDescriptor& operator=(const HighDescriptor&) = delete;
  ~HighDescriptor() { close(); }

  /// Returns -1 if no descriptor is owned.
  [[nodiscard]] int get() const { return descriptor_; }
  void close() {
    if (descriptor_ >= 0) {
      ::close(std::exchange(descriptor_, -1));
    }
  }

 private:
  int descriptor_ = -1;
};

struct Pipe {
  HighDescriptor read_end;
  HighDescriptor write_end;
};

/// Throws std::system_error.
[[nodiscard]] inline Pipe make_pipe() {
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    fail_with_errno("pipe");
  }
  Pipe pipe;
  pipe.read_end = HighDescriptor(ends[0]);
  pipe.write_end = HighDescriptor(ends[1]);
  return pipe;
}

}  // namespace tactree::support
