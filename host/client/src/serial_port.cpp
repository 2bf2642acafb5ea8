#include "tactree/client/serial_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "tactree/client/link_error.hpp"

namespace tactree::client {
namespace {

struct Speed {
  unsigned baud;
  speed_t code;
};

constexpr Speed kSpeeds[] = {{9600, B9600},       {19200, B19200},    {38400, B38400},
                             {57600, B57600},     {115200, B115200},  {230400, B230400},
                             {460800, B460800},   {921600, B921600},  {1000000, B1000000},
                             {2000000, B2000000}, {4000000, B4000000}};

speed_t speed_code(const std::string& path, unsigned baud) {
  for (const Speed& speed : kSpeeds) {
    if (speed.baud == baud) {
      return speed.code;
    }
  }
  throw LinkError(path + ": " + std::to_string(baud) +
                  " baud is not a supported speed (the default is " + std::to_string(kUsualBaud) +
                  "; others are 115200, 921600 and 2000000)");
}

[[noreturn]] void fail_port(const std::string& path, const std::string& remedy) {
  throw LinkError(path + ": " + std::strerror(errno) + " (" + remedy + ")");
}

std::string port_remedy(int error) {
  if (error == EACCES) {
    return "the user must be in the group dialout, or a udev rule must permit access";
  }
  if (error == EBUSY) {
    return "another program uses it; end it, or, if tactree serve shares it, use the port that "
           "tactree devices lists";
  }
  return "is the board plugged in? tactree devices lists the ports found";
}

void make_raw(int descriptor, speed_t speed) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) {
    return;  // not a terminal, nothing to set
  }
  ::cfmakeraw(&settings);
  ::cfsetspeed(&settings, speed);
  settings.c_cflag |= CLOCAL | CREAD;
  ::tcsetattr(descriptor, TCSANOW, &settings);
}

std::size_t read_some(int descriptor, std::span<std::byte> bytes, bool& gone) {
  const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
  if (count > 0) {
    return static_cast<std::size_t>(count);
  }
  const bool nothing = count < 0 && (errno == EAGAIN || errno == EINTR);
  gone = gone || !nothing;
  return 0;
}

std::size_t write_some(int descriptor, std::span<const std::byte> bytes, bool& gone) {
  if (bytes.empty()) {
    return 0;
  }
  const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
  if (count >= 0) {
    return static_cast<std::size_t>(count);
  }
  gone = gone || (errno != EAGAIN && errno != EINTR);
  return 0;
}

void wait_for(int descriptor, std::chrono::microseconds timeout) {
  pollfd wanted{descriptor, POLLIN, 0};
  const timespec limit{timeout.count() / 1'000'000, 1000 * (timeout.count() % 1'000'000)};
  (void)::ppoll(&wanted, 1, &limit, nullptr);
}

class SerialPort : public Transport {
 public:
  SerialPort(std::string path, unsigned baud) : path_(std::move(path)) {
    const speed_t speed = speed_code(path_, baud);
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0) {
      fail_port(path_, port_remedy(errno));
    }
    if (::isatty(descriptor_) == 0) {
      ::close(descriptor_);
      throw LinkError(path_ + ": not a serial port (tactree devices lists the ports found)");
    }
    // Two programs on one port would each receive only a part of the replies. The lock also keeps
    // out a program of root, which may open a port in exclusive use.
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 || ::ioctl(descriptor_, TIOCEXCL) != 0) {
      const int error = errno == EWOULDBLOCK ? EBUSY : errno;
      ::close(descriptor_);
      errno = error;
      fail_port(path_, port_remedy(error));
    }
    make_raw(descriptor_, speed);
    ::tcflush(descriptor_, TCIOFLUSH);
  }
  ~SerialPort() override {
    (void)::ioctl(descriptor_, TIOCNXCL);
    ::close(descriptor_);
  }

  std::size_t read(std::span<std::byte> bytes) override {
    return gone_ ? 0 : read_some(descriptor_, bytes, gone_);
  }
  std::size_t write(std::span<const std::byte> bytes) override {
    return gone_ ? 0 : write_some(descriptor_, bytes, gone_);
  }
  void wait(std::chrono::microseconds timeout) override { wait_for(descriptor_, timeout); }
  [[nodiscard]] bool connected() const override { return !gone_; }
  [[nodiscard]] std::string name() const override { return path_; }

 private:
  std::string path_;
  int descriptor_ = -1;
  bool gone_ = false;
};

}  // namespace

std::unique_ptr<Transport> open_serial_port(const std::string& path, unsigned baud) {
  return std::make_unique<SerialPort>(path, baud);
}

std::vector<std::string> serial_ports() {
  std::vector<std::string> ports;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("ttyACM") || name.starts_with("ttyUSB")) {
      ports.push_back(entry.path().string());
    }
  }
  std::sort(ports.begin(), ports.end());
  return ports;
}

PseudoTerminal::PseudoTerminal() {
  ours_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (ours_ < 0 || ::grantpt(ours_) != 0 || ::unlockpt(ours_) != 0) {
    fail_port("/dev/ptmx", "the system has no free pseudo-terminal");
  }
  path_ = ::ptsname(ours_);
  theirs_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  make_raw(theirs_ >= 0 ? theirs_ : ours_, B115200);
}

PseudoTerminal::~PseudoTerminal() {
  ::close(theirs_);
  ::close(ours_);
}

std::size_t PseudoTerminal::read(std::span<std::byte> bytes) {
  bool gone = false;
  return read_some(ours_, bytes, gone);
}

std::size_t PseudoTerminal::write(std::span<const std::byte> bytes) {
  bool gone = false;
  return write_some(ours_, bytes, gone);
}

void PseudoTerminal::wait(std::chrono::microseconds timeout) { wait_for(ours_, timeout); }

}  // namespace tactree::client
