// Loop and memory annotations: docs/BOUND.md.

#include "async_file.hpp"

#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace tactree::hal::linux_usb {
AsyncContext::AsyncContext() : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (event_ < 0 || syscall(SYS_io_setup, kOperationsMax, &context_) != 0) {
    throw std::runtime_error(std::string("io_setup: ") + std::strerror(errno));
  }
}

AsyncContext::~AsyncContext() {
  syscall(SYS_io_destroy, context_);
  close(event_);
}

bool AsyncContext::read(int file, std::span<std::byte> bytes, std::uint64_t tag) {
  return submit(IOCB_CMD_PREAD, file, bytes, tag);
}

bool AsyncContext::write(int file, std::span<const std::byte> bytes, std::uint64_t tag) {
  return submit(IOCB_CMD_PWRITE, file, bytes, tag);
}

bool AsyncContext::submit(std::uint16_t what, int file, std::span<const std::byte> bytes,
                          std::uint64_t tag) {
  iocb operation{};
  operation.aio_lio_opcode = what;
  operation.aio_fildes = static_cast<std::uint32_t>(file);
  operation.aio_buf = reinterpret_cast<std::uint64_t>(bytes.data());
  operation.aio_nbytes = bytes.size();
  operation.aio_data = tag;
  operation.aio_flags = IOCB_FLAG_RESFD;
  operation.aio_resfd = static_cast<std::uint32_t>(event_);
  iocb* operations[] = {&operation};
  return syscall(SYS_io_submit, context_, 1, operations) == 1;
}

std::span<const AsyncContext::Ended> AsyncContext::ended() {
  std::uint64_t signals = 0;
  (void)!::read(event_, &signals, sizeof(signals));
  std::array<io_event, kOperationsMax> events{};
  timespec no_time{};
  const long got = syscall(SYS_io_getevents, context_, 0, events.size(), events.data(), &no_time);
  const std::size_t count = got > 0 ? static_cast<std::size_t>(got) : 0;
  for (std::size_t i = 0; i < count; ++i) {  // bound: kOperationsMax
    ended_[i] = {events[i].data, events[i].res};
  }
  return std::span(ended_).first(count);
}

}  // namespace tactree::hal::linux_usb
