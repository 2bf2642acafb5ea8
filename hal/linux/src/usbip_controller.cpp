// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/usbip_controller.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace tactree::hal::linux_usb {
namespace {

constexpr std::uint32_t kSubmit = 1;
constexpr std::uint32_t kUnlink = 2;
constexpr std::uint32_t kSubmitReply = 3;
constexpr std::uint32_t kUnlinkReply = 4;
constexpr std::size_t kHeaderBytes = 48;
constexpr std::size_t kWords = 10;  // of a header before the setup packet
// Bytes. A longer request ends the connection: its length is not that of a message, and its bytes
// would be awaited indefinitely.
constexpr std::size_t kTransferMax = 1U << 20U;
constexpr std::size_t kOutgoingMax = 4096;  // bytes; limited as in a hardware controller
constexpr int kHighSpeed = 3;               // USB_SPEED_HIGH
constexpr char kHostController[] = "/sys/devices/platform/vhci_hcd.0/";

using Words = std::array<std::uint32_t, kWords>;

/// Finds a free high-speed port of the virtual host controller.
int free_port() {
  std::ifstream status(std::string(kHostController) + "status");
  if (!status) {
    throw std::runtime_error(
        std::string(kHostController) +
        "status: there is no virtual USB host controller (hint: modprobe vhci-hcd)");
  }
  std::string line;
  while (std::getline(status, line)) {  // bound: ports of the controller
    std::istringstream fields(line);
    std::string hub;
    int port = 0;
    int state = 0;
    if (fields >> hub >> port >> state && hub == "hs" && state == 4) {  // VDEV_ST_NULL
      return port;
    }
  }
  throw std::runtime_error(std::string(kHostController) +
                           "status: no free port (hint: unplug a virtual device)");
}

}  // namespace

/// A pending request of the host.
struct UsbIpController::Transfer {
  std::uint32_t sequence = 0;
  bool to_host = false;
  std::size_t length = 0;       // requested by the host
  std::vector<std::byte> data;  // from the host
  std::size_t taken = 0;        // bytes of `data` that were read
};

struct UsbIpController::Impl {
  int socket = -1;
  std::vector<std::byte> incoming;  // from the socket, not parsed yet
  std::vector<std::byte> outgoing;  // to the socket
  std::deque<UsbEvent> events;
  std::deque<std::pair<core::usb::SetupPacket, Transfer>> requests;  // of endpoint 0
  std::optional<Transfer> control;                                   // in progress
  std::map<std::uint8_t, std::deque<Transfer>> transfers;
  std::map<std::uint8_t, std::deque<std::byte>> waiting;  // to the host, not requested yet
  std::map<std::uint8_t, bool> halted;

  void drop();
  void receive();
  void flush();
  [[nodiscard]] bool take_message();
  void submit(const Words& words, const std::byte* setup, std::vector<std::byte> data);
  void unlink(std::uint32_t sequence, std::uint32_t which);
  void reply(std::uint32_t command, std::uint32_t sequence, int status, std::size_t length,
             std::span<const std::byte> data);
  void finish(const Transfer& transfer, int status, std::size_t length,
              std::span<const std::byte> data = {});
  void serve(std::uint8_t endpoint);
};

UsbIpController::UsbIpController() : impl_(std::make_unique<Impl>()) {}

UsbIpController::~UsbIpController() { unplug(); }

void UsbIpController::plug_in() {
  const int port = free_port();
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error(std::string("socketpair: ") + std::strerror(errno));
  }
  const std::string file = std::string(kHostController) + "attach";
  const std::string text = std::to_string(port) + " " + std::to_string(ends[1]) + " " +
                           std::to_string((1 << 16) + port) + " " + std::to_string(kHighSpeed);
  const int attach = open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const bool written =
      attach >= 0 && ::write(attach, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int error = errno;
  if (attach >= 0) {
    close(attach);
  }
  close(ends[1]);  // the kernel holds a separate reference
  if (!written) {
    close(ends[0]);
    throw std::runtime_error(file + ": " + std::strerror(error) +
                             (error == EACCES ? " (hint: run it as root)" : ""));
  }
  plug_into(ends[0]);
}

void UsbIpController::plug_into(int socket) {
  unplug();
  impl_->socket = socket;
  fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK);
  impl_->events.push_back({UsbEvent::Kind::kReset, core::usb::Speed::kHigh, {}});
  // The virtual host controller does not forward the request SET_ADDRESS.
  impl_->requests.push_back({{0, core::usb::kSetAddress, 1, 0, 0}, {}});
}

void UsbIpController::unplug() { impl_->drop(); }

bool UsbIpController::plugged_in() const { return impl_->socket >= 0; }

int UsbIpController::descriptor() const { return impl_->socket; }

void UsbIpController::Impl::drop() {
  if (socket < 0) {
    return;
  }
  close(socket);
  *this = Impl{};
  events.push_back({UsbEvent::Kind::kDisconnected, {}, {}});
}

void UsbIpController::Impl::receive() {
  std::array<std::byte, 4096> piece{};
  while (socket >= 0) {  // bound: what the socket holds
    const ssize_t count = recv(socket, piece.data(), piece.size(), 0);
    if (count > 0) {
      incoming.insert(incoming.end(), piece.begin(), piece.begin() + count);
    } else if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
      break;
    } else {
      drop();
    }
  }
  while (socket >= 0 && take_message()) {  // bound: messages in `incoming`
  }
}

void UsbIpController::Impl::flush() {
  while (socket >= 0 && !outgoing.empty()) {  // bound: bytes that wait
    const ssize_t count = send(socket, outgoing.data(), outgoing.size(), MSG_NOSIGNAL);
    if (count > 0) {
      outgoing.erase(outgoing.begin(), outgoing.begin() + count);
    } else if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
      return;
    } else {
      drop();
    }
  }
}

bool UsbIpController::Impl::take_message() {
  if (incoming.size() < kHeaderBytes) {
    return false;
  }
  Words words{};
  std::memcpy(words.data(), incoming.data(), sizeof(words));
  std::transform(words.begin(), words.end(), words.begin(), ntohl);
  const bool to_device = words[0] == kSubmit && words[3] == 0;
  const std::size_t length = words[0] == kSubmit ? words[6] : 0;
  if ((words[0] != kSubmit && words[0] != kUnlink) || length > kTransferMax) {
    drop();  // not USB/IP
    return false;
  }
  const std::size_t size = kHeaderBytes + (to_device ? length : 0);
  if (incoming.size() < size) {
    return false;
  }
  const std::vector<std::byte> message(incoming.begin(),
                                       incoming.begin() + static_cast<long>(size));
  incoming.erase(incoming.begin(), incoming.begin() + static_cast<long>(size));
  if (words[0] == kUnlink) {
    unlink(words[1], words[5]);
  } else {
    submit(words, message.data() + 4 * kWords, {message.begin() + kHeaderBytes, message.end()});
  }
  return true;
}

void UsbIpController::Impl::submit(const Words& words, const std::byte* setup,
                                   std::vector<std::byte> data) {
  Transfer transfer{words[1], words[3] != 0, words[6], std::move(data), 0};
  const auto number = static_cast<std::uint8_t>(words[4] & 0xFU);
  if (number == 0) {
    core::usb::SetupPacket packet;
    std::memcpy(&packet, setup, sizeof(packet));
    requests.emplace_back(packet, std::move(transfer));
    return;
  }
  const auto endpoint = static_cast<std::uint8_t>(number | (transfer.to_host ? 0x80U : 0U));
  transfers[endpoint].push_back(std::move(transfer));
  serve(endpoint);
}

/// The host cancels a request. It is dropped here unless its reply was already sent; a second reply
/// would end the connection.
void UsbIpController::Impl::unlink(std::uint32_t sequence, std::uint32_t which) {
  std::size_t dropped = std::erase_if(
      requests, [&](const auto& request) { return request.second.sequence == which; });
  for (auto& [endpoint, queue] : transfers) {  // bound: endpoints
    dropped += std::erase_if(queue, [&](const Transfer& t) { return t.sequence == which; });
  }
  if (control && control->sequence == which) {
    control->sequence = 0;
    ++dropped;
  }
  reply(kUnlinkReply, sequence, dropped != 0 ? -ECONNRESET : 0, 0, {});
}

void UsbIpController::Impl::reply(std::uint32_t command, std::uint32_t sequence, int status,
                                  std::size_t length, std::span<const std::byte> data) {
  std::array<std::uint32_t, kHeaderBytes / 4> words{};
  words[0] = htonl(command);
  words[1] = htonl(sequence);
  words[5] = htonl(static_cast<std::uint32_t>(status));
  words[6] = htonl(static_cast<std::uint32_t>(length));
  const auto bytes = std::as_bytes(std::span(words));
  outgoing.insert(outgoing.end(), bytes.begin(), bytes.end());
  outgoing.insert(outgoing.end(), data.begin(), data.end());
  flush();
}

void UsbIpController::Impl::finish(const Transfer& transfer, int status, std::size_t length,
                                   std::span<const std::byte> data) {
  if (transfer.sequence != 0) {  // 0: generated here, or cancelled by the host
    reply(kSubmitReply, transfer.sequence, status, length, data);
  }
}

/// Completes pending requests of the host with the available data.
void UsbIpController::Impl::serve(std::uint8_t endpoint) {
  auto& queue = transfers[endpoint];
  auto& bytes = waiting[endpoint];
  while (!queue.empty()) {  // bound: transfers of the endpoint
    const Transfer& transfer = queue.front();
    if (halted[endpoint]) {
      finish(transfer, -EPIPE, 0);
    } else if (transfer.to_host && !bytes.empty()) {
      const auto count = static_cast<long>(std::min(transfer.length, bytes.size()));
      const std::vector<std::byte> data(bytes.begin(), bytes.begin() + count);
      bytes.erase(bytes.begin(), bytes.begin() + count);
      finish(transfer, 0, data.size(), data);
    } else if (!transfer.to_host && transfer.taken == transfer.data.size()) {
      finish(transfer, 0, transfer.data.size());
    } else {
      return;
    }
    queue.pop_front();
  }
}

UsbEvent UsbIpController::next_event() {
  Impl& impl = *impl_;
  if (impl.events.empty()) {
    impl.receive();
    impl.flush();
  }
  // Events come before further requests: a transfer that follows the end of a halt must not be
  // stalled.
  if (!impl.events.empty()) {
    const UsbEvent event = impl.events.front();
    impl.events.pop_front();
    return event;
  }
  if (impl.control || impl.requests.empty()) {
    return {};
  }
  auto [setup, transfer] = std::move(impl.requests.front());
  impl.requests.pop_front();
  impl.control = std::move(transfer);
  return {UsbEvent::Kind::kSetup, core::usb::Speed::kHigh, setup};
}

void UsbIpController::control_send(std::span<const std::byte> data, bool) {
  impl_->finish(*impl_->control, 0, data.size(), data);
  impl_->control.reset();
}

void UsbIpController::control_receive(std::uint16_t) {
  impl_->events.push_back({UsbEvent::Kind::kData, {}, {}});  // the data arrived with the request
}

std::span<const std::byte> UsbIpController::control_data() const {
  return impl_->control ? std::span<const std::byte>(impl_->control->data)
                        : std::span<const std::byte>();
}

void UsbIpController::control_acknowledge() {
  impl_->finish(*impl_->control, 0, impl_->control->data.size());
  impl_->control.reset();
}

void UsbIpController::control_stall() {
  impl_->finish(*impl_->control, -EPIPE, 0);
  impl_->control.reset();
}

void UsbIpController::configure(bool) {
  impl_->waiting.clear();
  impl_->halted.clear();
}

void UsbIpController::halt(std::uint8_t endpoint, bool on) {
  impl_->halted[endpoint] = on;
  impl_->serve(endpoint);
}

std::size_t UsbIpController::read(std::uint8_t endpoint, std::span<std::byte> bytes) {
  impl_->receive();
  auto& queue = impl_->transfers[endpoint];
  std::size_t count = 0;
  while (!queue.empty() && count < bytes.size()) {  // bound: bytes.size(), an empty one is served
    Transfer& transfer = queue.front();
    const std::size_t piece = std::min(bytes.size() - count, transfer.data.size() - transfer.taken);
    std::copy_n(transfer.data.begin() + static_cast<long>(transfer.taken), piece,
                bytes.begin() + static_cast<long>(count));
    transfer.taken += piece;
    count += piece;
    impl_->serve(endpoint);
  }
  return count;
}

std::size_t UsbIpController::write(std::uint8_t endpoint, std::span<const std::byte> bytes) {
  auto& waiting = impl_->waiting[endpoint];
  const bool whole = endpoint == core::usb::kNewsIn;
  if (impl_->socket < 0 || waiting.size() >= kOutgoingMax || (whole && !waiting.empty())) {
    return 0;
  }
  const std::size_t count = std::min(bytes.size(), kOutgoingMax - waiting.size());
  waiting.insert(waiting.end(), bytes.begin(), bytes.begin() + static_cast<long>(count));
  impl_->serve(endpoint);
  return count;
}

}  // namespace tactree::hal::linux_usb
