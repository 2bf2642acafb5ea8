#include "tactree/client/usb_transport.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <deque>
#include <utility>
#include <vector>

#include "libusb.hpp"
#include "tactree/client/link_error.hpp"

namespace tactree::client {
namespace {

constexpr std::size_t kReads = 4;  // several are pending, so the board never waits for this side
constexpr std::size_t kReadBytes = 2048;  // a multiple of every packet size
constexpr std::size_t kWritesMax = 4;
constexpr std::size_t kWriteBytes = 2048;
constexpr std::size_t kBacklogMax = 1U << 20U;  // unread bytes; beyond it the board waits

struct FreeTransfer {
  void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
};

}  // namespace

struct UsbTransport::Impl {
  /// A transfer and its memory.
  struct Piece {
    Impl* owner = nullptr;
    std::unique_ptr<libusb_transfer, FreeTransfer> transfer{libusb_alloc_transfer(0)};
    std::vector<unsigned char> bytes;
    std::size_t written = 0;
    bool under_way = false;
  };

  UsbDeviceInfo info;
  Context context = make_context();
  Handle handle;
  LinkEndpoints endpoints;
  std::array<Piece, kReads> reads;
  std::array<Piece, kWritesMax> writes;
  Piece news;
  std::deque<std::byte> backlog;
  std::optional<core::usb::NewsPacket> latest;
  std::string reason;
  std::atomic<bool> lost = false;  // connected() may be called from another thread
  bool closing = false;

  explicit Impl(const UsbDeviceInfo& device) : info(device) {}

  void open();
  void start();
  void submit(Piece& piece);
  void lose(const std::string& why);
  [[nodiscard]] bool is_intact(Piece& piece);
  void pump(std::chrono::microseconds timeout);
  void close();
  [[nodiscard]] bool is_under_way() const;

  static void LIBUSB_CALL on_read(libusb_transfer* transfer);
  static void LIBUSB_CALL on_write(libusb_transfer* transfer);
  static void LIBUSB_CALL on_news(libusb_transfer* transfer);
};

void UsbTransport::Impl::open() {
  int error = LIBUSB_ERROR_NO_DEVICE;
  for_each_board(context.get(), [&](libusb_device* device, const libusb_device_descriptor&,
                                    const std::string& path) {
    libusb_device_handle* opened = nullptr;
    if (path == info.path && !handle) {
      endpoints = find_link(device).value_or(LinkEndpoints{});
      error = libusb_open(device, &opened);
      handle.reset(opened);
    }
  });
  if (error == LIBUSB_SUCCESS) {
    error = libusb_claim_interface(handle.get(), core::usb::kLinkInterface);
  }
  if (error == LIBUSB_SUCCESS) {
    // Both sides start with empty endpoints, whatever a preceding program left there.
    error = libusb_set_interface_alt_setting(handle.get(), core::usb::kLinkInterface, 0);
  }
  if (error != LIBUSB_SUCCESS) {
    fail(info.label(), error);
  }
}

void UsbTransport::Impl::start() {
  for (Piece& piece : reads) {
    piece.owner = this;
    piece.bytes.resize(kReadBytes);
    libusb_fill_bulk_transfer(piece.transfer.get(), handle.get(), endpoints.in, piece.bytes.data(),
                              static_cast<int>(piece.bytes.size()), &on_read, &piece, 0);
    submit(piece);
  }
  for (Piece& piece : writes) {
    piece.owner = this;
    piece.bytes.resize(kWriteBytes);
  }
  news.owner = this;
  news.bytes.resize(sizeof(core::usb::NewsPacket));
  libusb_fill_interrupt_transfer(news.transfer.get(), handle.get(), endpoints.news,
                                 news.bytes.data(), static_cast<int>(news.bytes.size()), &on_news,
                                 &news, 0);
  submit(news);
}

void UsbTransport::Impl::submit(Piece& piece) {
  const int error = libusb_submit_transfer(piece.transfer.get());
  piece.under_way = error == LIBUSB_SUCCESS;
  if (error != LIBUSB_SUCCESS) {
    lose(libusb_strerror(error));
  }
}

void UsbTransport::Impl::lose(const std::string& why) {
  if (!lost) {
    reason = why;
  }
  lost = true;
}

/// Call after a transfer has ended. A stall counts as a lost connection: both sides start afresh
/// when the board is opened again.
bool UsbTransport::Impl::is_intact(Piece& piece) {
  piece.under_way = false;
  if (piece.transfer->status == LIBUSB_TRANSFER_COMPLETED) {
    return !closing && !lost;
  }
  if (!closing) {
    const bool gone = piece.transfer->status == LIBUSB_TRANSFER_NO_DEVICE;
    lose(gone ? "unplugged" : "a transfer failed");
  }
  return false;
}

void UsbTransport::Impl::on_read(libusb_transfer* transfer) {
  Piece& piece = *static_cast<Piece*>(transfer->user_data);
  Impl& impl = *piece.owner;
  const auto* bytes = reinterpret_cast<const std::byte*>(piece.bytes.data());
  if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
    impl.backlog.insert(impl.backlog.end(), bytes, bytes + transfer->actual_length);
  }
  if (impl.is_intact(piece) && impl.backlog.size() < kBacklogMax) {
    impl.submit(piece);
  }
}

void UsbTransport::Impl::on_write(libusb_transfer* transfer) {
  Piece& piece = *static_cast<Piece*>(transfer->user_data);
  (void)piece.owner->is_intact(piece);
}

void UsbTransport::Impl::on_news(libusb_transfer* transfer) {
  Piece& piece = *static_cast<Piece*>(transfer->user_data);
  Impl& impl = *piece.owner;
  if (!impl.is_intact(piece)) {
    return;
  }
  if (transfer->actual_length == static_cast<int>(sizeof(core::usb::NewsPacket))) {
    std::memcpy(&impl.latest.emplace(), piece.bytes.data(), sizeof(core::usb::NewsPacket));
  }
  impl.submit(piece);
}

void UsbTransport::Impl::pump(std::chrono::microseconds timeout) {
  timeval time{};
  time.tv_sec = timeout.count() / 1'000'000;
  time.tv_usec = timeout.count() % 1'000'000;
  const int error = libusb_handle_events_timeout_completed(context.get(), &time, nullptr);
  if (error != LIBUSB_SUCCESS && error != LIBUSB_ERROR_INTERRUPTED) {
    lose(libusb_strerror(error));
  }
}

bool UsbTransport::Impl::is_under_way() const {
  const auto busy = [](const Piece& piece) { return piece.under_way; };
  return busy(news) || std::any_of(reads.begin(), reads.end(), busy) ||
         std::any_of(writes.begin(), writes.end(), busy);
}

/// libusb returns every transfer once. Until then its memory must not be freed.
void UsbTransport::Impl::close() {
  closing = true;
  const auto cancel = [](Piece& piece) {
    if (piece.under_way) {
      libusb_cancel_transfer(piece.transfer.get());
    }
  };
  std::for_each(reads.begin(), reads.end(), cancel);
  std::for_each(writes.begin(), writes.end(), cancel);
  cancel(news);
  while (is_under_way()) {
    pump(std::chrono::milliseconds(100));
  }
}

UsbTransport::UsbTransport(const UsbDeviceInfo& device) : impl_(std::make_unique<Impl>(device)) {
  impl_->open();
  impl_->start();
}

UsbTransport::~UsbTransport() { impl_->close(); }

std::size_t UsbTransport::read(std::span<std::byte> bytes) {
  Impl& impl = *impl_;
  impl.pump(std::chrono::microseconds(0));
  const std::size_t count = std::min(bytes.size(), impl.backlog.size());
  std::copy_n(impl.backlog.begin(), count, bytes.begin());
  impl.backlog.erase(impl.backlog.begin(), impl.backlog.begin() + static_cast<long>(count));
  for (Impl::Piece& piece : impl.reads) {
    if (!piece.under_way && !impl.lost && impl.backlog.size() < kBacklogMax) {
      impl.submit(piece);
    }
  }
  return count;
}

std::size_t UsbTransport::write(std::span<const std::byte> bytes) {
  Impl& impl = *impl_;
  impl.pump(std::chrono::microseconds(0));
  std::size_t count = 0;
  for (Impl::Piece& piece : impl.writes) {
    if (impl.lost || count == bytes.size()) {
      break;
    }
    if (piece.under_way) {
      continue;
    }
    const std::size_t size = std::min(bytes.size() - count, piece.bytes.size());
    std::memcpy(piece.bytes.data(), bytes.data() + count, size);
    libusb_fill_bulk_transfer(piece.transfer.get(), impl.handle.get(), impl.endpoints.out,
                              piece.bytes.data(), static_cast<int>(size), &Impl::on_write, &piece,
                              0);
    impl.submit(piece);
    count += piece.under_way ? size : 0;
  }
  return count;
}

void UsbTransport::wait(std::chrono::microseconds timeout) {
  if (impl_->backlog.empty() && !impl_->lost) {
    impl_->pump(timeout);
  }
}

bool UsbTransport::connected() const { return !impl_->lost; }

std::string UsbTransport::name() const { return impl_->info.label(); }

std::optional<core::usb::NewsPacket> UsbTransport::take_news() {
  impl_->pump(std::chrono::microseconds(0));
  return std::exchange(impl_->latest, std::nullopt);
}

std::string UsbTransport::reason() const { return impl_->reason; }

std::unique_ptr<UsbTransport> open_usb(const std::string& which) {
  const std::vector<UsbDeviceInfo> devices = list_usb_devices();
  std::string there;
  std::vector<UsbDeviceInfo> chosen;
  for (const UsbDeviceInfo& device : devices) {
    there += "\n  " + device.label() + " " + device.serial + " " + device.problem;
    if (which.empty() || which == device.serial || which == device.path) {
      chosen.push_back(device);
    }
  }
  if (chosen.size() == 1) {
    return std::make_unique<UsbTransport>(chosen.front());
  }
  if (devices.empty()) {
    throw LinkError("usb: no board is plugged in (hint: `tactree devices` lists the boards)");
  }
  throw LinkError("usb: " +
                  std::string(chosen.empty() ? "no board is '" + which + "'"
                                             : "several boards are plugged in") +
                  " (hint: name one by serial number or path)" + there);
}

}  // namespace tactree::client
