#include "tactree/client/lock_step.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "tactree/client/link_error.hpp"

namespace tactree::client {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

constexpr const char* kScheme = "step:";
constexpr std::size_t kMaxBytes = 32768;      // of a packet, after its time
constexpr std::size_t kMaxUnread = 1U << 20;  // bytes that may wait for the other side
constexpr int kLookEvery_ms = 100;  // checks `ended` at least this often; a signal ends the wait

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    throw LinkError(
        path + ": not the path of a socket (give the path that tactree simulate --serve printed)");
  }
  path.copy(address.sun_path, path.size());
  return address;
}

int new_socket() { return ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0); }

/// Sends a time, then as many bytes as fit, and removes these from `bytes`. Returns false if the
/// other side is gone.
template <class Time>
bool send_packet(int descriptor, Time time, std::vector<std::byte>& bytes) {
  const std::size_t count = std::min(bytes.size(), kMaxBytes);
  std::array<std::byte, sizeof(Time) + kMaxBytes> packet;
  std::memcpy(packet.data(), &time, sizeof time);
  std::copy_n(bytes.begin(), count, packet.begin() + sizeof time);
  ssize_t sent = 0;
  do {
    sent = ::send(descriptor, packet.data(), sizeof time + count, MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
  return sent >= 0;
}

/// Waits for the next packet and appends its bytes. Returns false if the other side is gone.
template <class Time>
bool receive_packet(int descriptor, Time& time, std::vector<std::byte>& bytes) {
  std::array<std::byte, sizeof(Time) + kMaxBytes> packet;
  ssize_t count = 0;
  do {
    count = ::recv(descriptor, packet.data(), packet.size(), 0);
  } while (count < 0 && errno == EINTR);
  if (count < static_cast<ssize_t>(sizeof time)) {
    return false;
  }
  std::memcpy(&time, packet.data(), sizeof time);
  bytes.insert(bytes.end(), packet.begin() + sizeof time, packet.begin() + count);
  return true;
}

std::size_t take(std::vector<std::byte>& from, std::span<std::byte> to) {
  const std::size_t count = std::min(from.size(), to.size());
  std::copy_n(from.begin(), count, to.begin());
  from.erase(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

std::size_t put(std::span<const std::byte> from, std::vector<std::byte>& to) {
  const std::size_t count = std::min(from.size(), kMaxUnread - std::min(kMaxUnread, to.size()));
  to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

class LockStepPort : public Transport {
 public:
  explicit LockStepPort(std::string path) : path_(std::move(path)) {
    const sockaddr_un address = address_of(path_);
    descriptor_ = new_socket();
    if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      const int error = errno;
      ::close(descriptor_);
      throw LinkError(name() + ": " + std::strerror(error) +
                      " (is tactree simulate --serve --lock-step running?)");
    }
    exchange(microseconds(0));
  }
  ~LockStepPort() override { ::close(descriptor_); }

  std::size_t read(std::span<std::byte> bytes) override { return take(in_, bytes); }
  std::size_t write(std::span<const std::byte> bytes) override {
    return gone_ ? 0 : put(bytes, out_);
  }
  void wait(microseconds timeout) override {
    if (in_.empty() && !gone_) {
      exchange(timeout);
    }
  }
  /// Once the board is gone, real time passes instead, because requests must time out.
  [[nodiscard]] microseconds now() const override {
    return microseconds(now_us_) + (gone_ ? Transport::now() - gone_at_ : microseconds(0));
  }
  [[nodiscard]] bool in_lock_step() const override { return true; }
  [[nodiscard]] bool connected() const override { return !gone_; }
  [[nodiscard]] std::string name() const override { return kScheme + path_; }

 private:
  void exchange(microseconds granted) {
    std::uint64_t now_us = 0;
    if (send_packet(descriptor_, static_cast<std::uint32_t>(granted.count()), out_) &&
        receive_packet(descriptor_, now_us, in_)) {
      now_us_ = now_us;
    } else {
      gone_at_ = Transport::now();
      gone_ = true;
    }
  }

  std::string path_;
  int descriptor_ = -1;
  std::atomic<bool> gone_ = false;
  microseconds gone_at_{0};  // written before gone_
  std::atomic<std::uint64_t> now_us_ = 0;
  std::vector<std::byte> in_;
  std::vector<std::byte> out_;
};

}  // namespace

std::unique_ptr<Transport> open_lock_step(const std::string& path) {
  return std::make_unique<LockStepPort>(path);
}

// If the body throws, the destructor still runs, because the delegated constructor has completed.
LockStepServer::LockStepServer() : LockStepServer(new_socket()) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  if (error) {
    throw LinkError("the folder for temporary files: " + error.message() +
                    " (set TMPDIR to one that exists)");
  }
  std::string folder = (parent / "tactree-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) {
    throw LinkError(folder + ": " + std::strerror(errno) + " (is the folder writable?)");
  }
  path_ = folder + "/board";
  const sockaddr_un address = address_of(path_);
  if (::bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listening_, 1) != 0) {
    throw LinkError(path_ + ": " + std::strerror(errno) + " (is the folder writable?)");
  }
}

LockStepServer::~LockStepServer() {
  for (const Program& program : programs_) {
    ::close(program.descriptor);
  }
  ::close(listening_);
  std::error_code ignored;
  std::filesystem::remove_all(std::filesystem::path(path_).parent_path(), ignored);
}

std::size_t LockStepServer::read(std::span<std::byte> bytes) { return take(in_, bytes); }

std::size_t LockStepServer::write(std::span<const std::byte> bytes) {
  for (Program& program : programs_) {
    (void)put(bytes, program.out);  // bytes without room are lost, as on a serial port
  }
  return bytes.size();
}

microseconds LockStepServer::now() const { return std::chrono::duration_cast<microseconds>(now_); }

std::string LockStepServer::name() const { return kScheme + path_; }

void LockStepServer::pass(nanoseconds tick, const std::function<bool()>& ended) {
  now_ += tick;
  answer_what_is_due();
  while (!ended() && !all_wait()) {
    take_requests();
    answer_what_is_due();
  }
}

void LockStepServer::answer_what_is_due() {
  for (Program& program : programs_) {
    if (program.asked && (now_ >= program.until || !program.out.empty())) {
      program.asked = false;
      program.until = std::min(program.until, now_);  // the program grants the remaining time again
      (void)send_packet(program.descriptor, static_cast<std::uint64_t>(now().count()), program.out);
    }
  }
}

bool LockStepServer::all_wait() const {
  return !programs_.empty() && std::all_of(programs_.begin(), programs_.end(),
                                           [](const Program& program) { return program.asked; });
}

/// Accepts programs, reads their requests, and removes those that are gone.
void LockStepServer::take_requests() {
  std::vector<pollfd> wanted{{listening_, POLLIN, 0}};
  for (const Program& program : programs_) {
    wanted.push_back({program.descriptor, POLLIN, 0});
  }
  if (::poll(wanted.data(), wanted.size(), kLookEvery_ms) <= 0) {
    return;
  }
  for (std::size_t i = 0; i < programs_.size(); ++i) {
    if (wanted[i + 1].revents != 0) {
      take_request(programs_[i]);
    }
  }
  std::erase_if(programs_, [](const Program& program) { return program.descriptor < 0; });
  if (wanted[0].revents != 0) {
    programs_.push_back({::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC), false, now_, {}});
  }
}

void LockStepServer::take_request(Program& program) {
  std::uint32_t granted_us = 0;
  program.asked = receive_packet(program.descriptor, granted_us, in_);
  program.until += microseconds(granted_us);
  if (!program.asked) {
    ::close(program.descriptor);
    program.descriptor = -1;
  }
}

}  // namespace tactree::client
