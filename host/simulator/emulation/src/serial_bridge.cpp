#include "serial_bridge.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "tactree/emulation/emulation_error.hpp"

namespace tactree::emulation {
namespace {

// Bytes. All output that is waiting is discarded if it exceeds this, to limit the memory when no
// program reads.
constexpr std::size_t kMaxWaiting = 1U << 20U;

}  // namespace

SerialBridge::SerialBridge(client::Transport& programs) : programs_(programs) {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw EmulationError(std::string("socket for the board's serial port: ") +
                         std::strerror(errno));
  }
  ours_ = support::HighDescriptor(ends[0]);
  board_ = support::HighDescriptor(ends[1]);
}

void SerialBridge::move() {
  std::array<std::byte, 4096> bytes{};
  for (std::size_t count = 0; (count = programs_.read(bytes)) > 0U;) {
    to_board_.insert(to_board_.end(), bytes.begin(),
                     bytes.begin() + static_cast<std::ptrdiff_t>(count));
  }
  for (ssize_t count = 0;
       (count = ::recv(ours_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0;) {
    to_programs_.insert(to_programs_.end(), bytes.begin(), bytes.begin() + count);
  }
  flush();
}

void SerialBridge::flush() {
  if (!to_board_.empty()) {
    const ssize_t count =
        ::send(ours_.get(), to_board_.data(), to_board_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    to_board_.erase(to_board_.begin(), to_board_.begin() + (count > 0 ? count : 0));
  }
  const std::size_t written = programs_.write(to_programs_);
  to_programs_.erase(to_programs_.begin(),
                     to_programs_.begin() + static_cast<std::ptrdiff_t>(written));
  if (to_programs_.size() > kMaxWaiting) {
    to_programs_.clear();
  }
}

}  // namespace tactree::emulation
