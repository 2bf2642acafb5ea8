// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/function_fs_controller.hpp"

#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "async_file.hpp"
#include "function_fs_descriptors.hpp"
#include "gadget.hpp"

namespace tactree::hal::linux_usb {
namespace {

constexpr std::size_t kPieceBytes = 2048;  // a multiple of every packet size
// Pending operations per endpoint: the kernel always has one to continue with while the others are
// processed, up to 8 KiB later.
constexpr std::size_t kPieces = 4;
constexpr std::size_t kEndpoints = 3;
constexpr std::size_t kCameMax = 2 * kPieces * kPieceBytes;  // received, and pending
constexpr std::size_t kEventsMax = 8;  // four from the kernel, and those added here
constexpr std::size_t kControlBytesMax = 65535;

// In the order of their descriptors: FunctionFS names their files ep1, ep2, ep3.
constexpr std::array<std::uint8_t, kEndpoints> kAddresses = {
    core::usb::kBulkOut, core::usb::kBulkIn, core::usb::kNewsIn};

std::size_t index_of(std::uint8_t endpoint) {
  const auto* const found = std::find(kAddresses.begin(), kAddresses.end(), endpoint);
  return static_cast<std::size_t>(found - kAddresses.begin());
}

bool is_to_host(std::size_t endpoint) { return (kAddresses[endpoint] & 0x80U) != 0U; }

int open_file(const std::string& name) {
  const int file = open(name.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) {
    throw std::runtime_error(name + ": " + std::strerror(errno) + " (hint: run it as root)");
  }
  return file;
}

}  // namespace

struct FunctionFsController::Impl {
  struct Piece {
    std::vector<std::byte> bytes = std::vector<std::byte>(kPieceBytes);
    bool under_way = false;
  };
  struct Endpoint {
    int file = -1;
    std::array<Piece, kPieces> pieces;
    std::vector<std::byte> came;  // bytes from the host that read() has not returned yet
  };
  /// State while the device is plugged in.
  struct Plugged {
    Plugged(const core::usb::Identity& identity, bool dfu) : gadget(identity), with_dfu(dfu) {
      for (Endpoint& endpoint : endpoints) {  // bound: kEndpoints
        endpoint.came.reserve(kCameMax);
      }
    }
    ~Plugged() {
      async.reset();  // first, because pending operations use the endpoints' memory
      for (const Endpoint& endpoint : endpoints) {  // bound: kEndpoints
        close_if_open(endpoint.file);
      }
      close_if_open(control);
      close_if_open(either);
    }
    Plugged(const Plugged&) = delete;
    Plugged& operator=(const Plugged&) = delete;
    static void close_if_open(int file) {
      if (file >= 0) {
        close(file);
      }
    }

    Gadget gadget;
    int control = -1;
    int either = -1;  // epoll of endpoint 0 and of ended operations
    bool with_dfu;
    bool enabled = false;
    std::array<Endpoint, kEndpoints> endpoints;
    std::unique_ptr<AsyncContext> async = std::make_unique<AsyncContext>();
  };

  core::usb::Identity identity;
  std::string udc;
  bool offers_dfu = true;
  std::unique_ptr<Plugged> plugged;
  std::vector<UsbEvent> events;
  core::usb::SetupPacket setup{};
  std::vector<std::byte> received;

  void open_function();
  [[nodiscard]] bool describe(bool with_dfu);
  void watch();
  void take_events();
  void take_event(const usb_functionfs_event& event);
  void take_ended();
  void start_reads();
};

FunctionFsController::FunctionFsController(const core::usb::Identity& identity, std::string udc,
                                           bool with_dfu)
    : impl_(std::make_unique<Impl>()) {
  impl_->offers_dfu = with_dfu;
  impl_->events.reserve(kEventsMax);
  impl_->received.reserve(kControlBytesMax);
  impl_->identity = identity;
  impl_->udc = std::move(udc);
}

FunctionFsController::~FunctionFsController() = default;

void FunctionFsController::plug_in() {
  unplug();
  const std::string udc = find_udc(impl_->udc);
  impl_->plugged = std::make_unique<Impl::Plugged>(impl_->identity, impl_->offers_dfu);
  try {
    impl_->open_function();
    impl_->plugged->gadget.bind(udc);
  } catch (...) {
    impl_->plugged.reset();
    throw;
  }
}

void FunctionFsController::unplug() {
  if (impl_->plugged) {
    impl_->plugged.reset();
    impl_->events.clear();
    impl_->events.push_back({UsbEvent::Kind::kDisconnected, {}, {}});
  }
}

bool FunctionFsController::plugged_in() const { return impl_->plugged != nullptr; }
int FunctionFsController::descriptor() const { return plugged_in() ? impl_->plugged->either : -1; }

void FunctionFsController::Impl::open_function() {
  plugged->control = open_file(plugged->gadget.mount() + "/ep0");
  bool taken = describe(plugged->with_dfu);
  if (!taken && plugged->with_dfu) {
    close(plugged->control);  // after a refusal the file accepts no other descriptors
    plugged->control = open_file(plugged->gadget.mount() + "/ep0");
    plugged->with_dfu = false;
    taken = describe(false);
  }
  if (!taken) {
    throw std::runtime_error(plugged->gadget.mount() + "/ep0: " + std::strerror(errno) +
                             " (hint: use a kernel whose FunctionFS supports this device)");
  }
  for (std::size_t i = 0; i < kEndpoints; ++i) {  // bound: kEndpoints
    plugged->endpoints[i].file = open_file(plugged->gadget.mount() + "/ep" + std::to_string(i + 1));
  }
  watch();
}

bool FunctionFsController::Impl::describe(bool with_dfu) {
  for (const auto& bytes :  // bound: 2
       {function_fs_descriptors(with_dfu), function_fs_strings(with_dfu)}) {
    if (::write(plugged->control, bytes.data(), bytes.size()) !=
        static_cast<ssize_t>(bytes.size())) {
      return false;
    }
  }
  return true;
}

void FunctionFsController::Impl::watch() {
  plugged->either = epoll_create1(EPOLL_CLOEXEC);
  for (const int file : {plugged->control, plugged->async->descriptor()}) {  // bound: 2
    epoll_event event{};
    event.events = EPOLLIN;
    epoll_ctl(plugged->either, EPOLL_CTL_ADD, file, &event);
  }
}

void FunctionFsController::Impl::take_events() {
  std::array<usb_functionfs_event, 4> came{};
  pollfd ready{plugged->control, POLLIN, 0};
  if (poll(&ready, 1, 0) != 1 || (ready.revents & POLLIN) == 0) {
    return;
  }
  const ssize_t size = ::read(plugged->control, came.data(), sizeof(came));
  const std::size_t count = size > 0 ? static_cast<std::size_t>(size) / sizeof(came[0]) : 0;
  for (std::size_t i = 0; i < count; ++i) {  // bound: 4
    take_event(came[i]);
  }
}

void FunctionFsController::Impl::take_event(const usb_functionfs_event& event) {
  if (event.type == FUNCTIONFS_ENABLE) {
    plugged->enabled = true;
    start_reads();
    events.push_back({UsbEvent::Kind::kConfigured, {}, {}});
  } else if (event.type == FUNCTIONFS_DISABLE || event.type == FUNCTIONFS_UNBIND) {
    plugged->enabled = false;
    for (Endpoint& endpoint : plugged->endpoints) {  // bound: kEndpoints
      endpoint.came.clear();
    }
    events.push_back({UsbEvent::Kind::kUnconfigured, {}, {}});
  } else if (event.type == FUNCTIONFS_SETUP) {
    std::memcpy(static_cast<void*>(&setup), &event.u.setup, sizeof(setup));
    events.push_back({UsbEvent::Kind::kSetup, {}, setup});
  }
}

void FunctionFsController::Impl::start_reads() {
  for (std::size_t i = 0; i < kEndpoints; ++i) {  // bound: kEndpoints
    Endpoint& endpoint = plugged->endpoints[i];
    const bool room = endpoint.came.size() < kPieces * kPieceBytes;
    for (std::size_t k = 0; !is_to_host(i) && room && plugged->enabled && k < kPieces;
         ++k) {  // bound: kPieces
      Piece& piece = endpoint.pieces[k];
      if (!piece.under_way) {
        piece.under_way = plugged->async->read(endpoint.file, piece.bytes, i * kPieces + k);
      }
    }
  }
}

void FunctionFsController::Impl::take_ended() {
  for (const AsyncContext::Ended& ended : plugged->async->ended()) {  // bound: what has ended
    const auto number = static_cast<std::size_t>(ended.tag / kPieces);
    Endpoint& endpoint = plugged->endpoints[number];
    Piece& piece = endpoint.pieces[static_cast<std::size_t>(ended.tag % kPieces)];
    piece.under_way = false;
    if (!is_to_host(number) && ended.result > 0) {
      endpoint.came.insert(endpoint.came.end(), piece.bytes.begin(),
                           piece.bytes.begin() + static_cast<std::ptrdiff_t>(ended.result));
    }
  }
  start_reads();
}

UsbEvent FunctionFsController::next_event() {
  if (impl_->plugged) {
    impl_->take_ended();
    if (impl_->events.empty()) {
      impl_->take_events();
    }
  }
  if (impl_->events.empty()) {
    return {};
  }
  const UsbEvent event = impl_->events.front();
  impl_->events.erase(impl_->events.begin());
  return event;
}

void FunctionFsController::control_send(std::span<const std::byte> data, bool) {
  (void)!::write(impl_->plugged->control, data.data(), data.size());
}

void FunctionFsController::control_receive(std::uint16_t bytes) {
  impl_->received.resize(bytes);
  const ssize_t count = ::read(impl_->plugged->control, impl_->received.data(), bytes);
  impl_->received.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  impl_->events.push_back({UsbEvent::Kind::kData, {}, {}});
}

std::span<const std::byte> FunctionFsController::control_data() const { return impl_->received; }

/// A request without data is completed by an empty read; one with data was completed by its
/// transfer.
void FunctionFsController::control_acknowledge() {
  if (impl_->setup.wLength == 0) {
    (void)!::read(impl_->plugged->control, nullptr, 0);
  }
}

/// FunctionFS stalls endpoint 0 when it is accessed in the direction opposite to the request.
void FunctionFsController::control_stall() {
  if (impl_->setup.to_host()) {
    (void)!::read(impl_->plugged->control, nullptr, 0);
  } else {
    (void)!::write(impl_->plugged->control, nullptr, 0);
  }
}

std::size_t FunctionFsController::read(std::uint8_t endpoint, std::span<std::byte> bytes) {
  if (!impl_->plugged) {
    return 0;
  }
  impl_->take_ended();
  auto& came = impl_->plugged->endpoints[index_of(endpoint)].came;
  const std::size_t count = std::min(bytes.size(), came.size());
  std::copy_n(came.begin(), count, bytes.begin());
  came.erase(came.begin(), came.begin() + static_cast<long>(count));
  return count;
}

std::size_t FunctionFsController::write(std::uint8_t endpoint, std::span<const std::byte> bytes) {
  if (!impl_->plugged || !impl_->plugged->enabled) {
    return 0;
  }
  impl_->take_ended();
  const std::size_t index = index_of(endpoint);
  Impl::Endpoint& to = impl_->plugged->endpoints[index];
  for (std::size_t k = 0; k < kPieces; ++k) {  // bound: kPieces
    Impl::Piece& piece = to.pieces[k];
    if (!piece.under_way) {
      const std::size_t count = std::min(bytes.size(), piece.bytes.size());
      std::copy_n(bytes.begin(), count, piece.bytes.begin());
      piece.under_way = impl_->plugged->async->write(
          to.file, std::span<const std::byte>(piece.bytes).first(count), index * kPieces + k);
      return piece.under_way ? count : 0;
    }
  }
  return 0;
}

}  // namespace tactree::hal::linux_usb
