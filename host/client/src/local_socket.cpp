#include "tactree/client/local_socket.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "tactree/client/link_error.hpp"

namespace tactree::client {
namespace {

std::string socket_remedy(int error) {
  if (error == EACCES || error == EPERM) {
    return "the user must be in the group of the controller";
  }
  return "is tactree-controller or tactree serve running, and is this its socket?";
}

int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    throw LinkError(path + ": not the path of a socket (give the path in the controller's file)");
  }
  path.copy(address.sun_path, path.size());
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const int error = errno;
    ::close(descriptor);
    throw LinkError(path + ": " + std::strerror(error) + " (" + socket_remedy(error) + ")");
  }
  return descriptor;
}

class LocalSocket : public Transport {
 public:
  explicit LocalSocket(std::string path) : path_(std::move(path)), descriptor_(connect_to(path_)) {}
  ~LocalSocket() override { ::close(descriptor_); }

  std::size_t read(std::span<std::byte> bytes) override {
    return gone_ || bytes.empty() ? 0 : note(::recv(descriptor_, bytes.data(), bytes.size(), 0));
  }
  std::size_t write(std::span<const std::byte> bytes) override {
    return gone_ || bytes.empty()
               ? 0
               : note(::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL));
  }
  void wait(std::chrono::microseconds timeout) override {
    pollfd wanted{descriptor_, POLLIN, 0};
    const timespec limit{timeout.count() / 1'000'000, 1000 * (timeout.count() % 1'000'000)};
    (void)::ppoll(&wanted, 1, &limit, nullptr);
  }
  [[nodiscard]] bool connected() const override { return !gone_; }
  [[nodiscard]] std::string name() const override { return "unix:" + path_; }

 private:
  std::size_t note(ssize_t count) {
    gone_ = gone_ || count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
    return count > 0 ? static_cast<std::size_t>(count) : 0U;
  }

  std::string path_;
  int descriptor_;
  bool gone_ = false;
};

}  // namespace

std::unique_ptr<Transport> open_local_socket(const std::string& path) {
  return std::make_unique<LocalSocket>(path);
}

}  // namespace tactree::client
