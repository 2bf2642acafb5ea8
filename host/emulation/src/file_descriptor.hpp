#pragma once
// A file descriptor that closes itself, numbered above those a child process is given.

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "tactree/emulation/emulation_error.hpp"

namespace tactree::emulation {

[[noreturn]] inline void fail_with_errno(const std::string& what) {
  throw EmulationError(what + ": " + std::strerror(errno));
}

class FileDescriptor {
 public:
  static constexpr int kLowest = 10;

  FileDescriptor() = default;
  /// Takes `descriptor` over and moves it to a number >= kLowest; not for child processes.
  explicit FileDescriptor(int descriptor) {
    descriptor_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, kLowest);
    const int cause = errno;
    ::close(descriptor);
    if (descriptor_ < 0) {
      errno = cause;
      fail_with_errno("emulation: a file descriptor");
    }
  }
  FileDescriptor(FileDescriptor&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~FileDescriptor() { close(); }

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
  FileDescriptor read_end;
  FileDescriptor write_end;
};

inline Pipe make_pipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    fail_with_errno("emulation: a pipe");
  }
  Pipe pipe;
  pipe.read_end = FileDescriptor(ends[0]);
  pipe.write_end = FileDescriptor(ends[1]);
  return pipe;
}

}  // namespace tactree::emulation
