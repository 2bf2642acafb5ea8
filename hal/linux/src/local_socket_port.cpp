#include "tactree/hal/linux/local_socket_port.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace tactree::hal {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& cause,
                       const std::string& remedy) {
  throw SocketError(path + ": " + cause + " (hint: " + remedy + ")");
}

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    fail(path, "not a path of 1 .. " + std::to_string(sizeof(address.sun_path) - 1) + " bytes",
         "choose another path");
  }
  path.copy(address.sun_path, path.size());
  return address;
}

FileDescriptor new_socket() {
  return FileDescriptor(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

const sockaddr* plain(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

/// Removes the socket that a killed program left: no process listens on it.
void remove_left_over(const std::string& path, const sockaddr_un& address) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0) {
    return;
  }
  if (!S_ISSOCK(found.st_mode)) {
    fail(path, "exists and is not a socket", "choose another path");
  }
  const FileDescriptor probe = new_socket();
  if (connect(probe.get(), plain(address), sizeof(address)) == 0 || errno == EAGAIN) {
    fail(path, "in use by another controller", "end it, or choose another path");
  }
  (void)::unlink(path.c_str());
}

}  // namespace

LocalSocketPort::LocalSocketPort(std::string path)
    : path_(std::move(path)), listener_(new_socket()) {
  const sockaddr_un address = address_of(path_);
  remove_left_over(path_, address);
  const mode_t before = umask(0117);
  const int bound = bind(listener_.get(), plain(address), sizeof(address));
  const int error = errno;
  umask(before);
  if (bound != 0 || listen(listener_.get(), 1) != 0) {
    fail(path_, std::strerror(bound != 0 ? error : errno),
         "create its folder, and permit this user to write to it");
  }
}

LocalSocketPort::~LocalSocketPort() { (void)::unlink(path_.c_str()); }

void LocalSocketPort::accept() noexcept {
  FileDescriptor peer(accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!connected()) {
    peer_ = std::move(peer);
  }
}

// EAGAIN and EINTR are temporary; any other error, and the end of the stream, closes the
// connection.
void LocalSocketPort::note(long result) noexcept {
  if (result == 0 || (result < 0 && errno != EAGAIN && errno != EINTR)) {
    peer_ = FileDescriptor();
  }
}

std::size_t LocalSocketPort::read(std::span<std::byte> bytes) noexcept {
  if (!connected() || bytes.empty()) {
    return 0;
  }
  const ssize_t count = recv(peer_.get(), bytes.data(), bytes.size(), 0);
  note(count);
  return count > 0 ? static_cast<std::size_t>(count) : 0U;
}

std::size_t LocalSocketPort::write(std::span<const std::byte> bytes) noexcept {
  if (bytes.empty()) {
    return 0;
  }
  if (!connected()) {
    return bytes.size();  // dropped, because the next application must not receive it
  }
  const ssize_t count = send(peer_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  note(count);
  return count > 0 ? static_cast<std::size_t>(count) : 0U;
}

}  // namespace tactree::hal
