#pragma once
// A full-speed USB host at the faked OTG FS core: control transfers, and bulk and interrupt
// transfers as libusb submits them. One call of step() is one transaction (USB 2.0, 8.5).

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "fake_usb_otg.hpp"
#include "tactree/core/link/usb/descriptors.hpp"
#include "tactree/core/link/usb/setup.hpp"

namespace tactree::test {

/// A transfer at a bulk or interrupt endpoint.
struct UsbTransfer {
  std::uint32_t id = 0;       ///< 0: of the host itself
  std::uint8_t endpoint = 0;  ///< with bit 7: to the host; ends with a short packet, or full
  std::size_t size = 0;       ///< bytes at most
  UsbBytes bytes;             ///< to the device, or received up to now
  std::size_t sent = 0;

  [[nodiscard]] bool to_host() const { return (endpoint & 0x80U) != 0U; }
};

class UsbHost {
 public:
  using SetupPacket = core::usb::SetupPacket;
  enum class Result : std::uint8_t { kPending, kDone, kStalled, kFailed };
  struct Ended {
    UsbTransfer transfer;
    Result result = Result::kDone;
  };

  explicit UsbHost(FakeUsbOtg& core) : core_(core) {}

  // Behaviour.
  bool reads = true;          ///< asks for bulk data and news by itself
  bool loses = false;         ///< every eighth handshake or so
  std::uint32_t address = 0;  ///< of the device

  /// Reset of the port. The host forgets its transfers.
  void begin_reset() {
    control_ = {};
    control_.result = Result::kFailed;
    pipes_ = make_pipes();
    configured_ = false;
    address = 0;
    core_.begin_bus_reset();
  }
  void end_reset() { core_.end_bus_reset(); }

  void submit(const SetupPacket& setup, const UsbBytes& data = {}) {
    control_ = {};
    control_.setup = setup;
    control_.out = data;
  }
  [[nodiscard]] Result result() const { return control_.result; }
  [[nodiscard]] const UsbBytes& answer() const { return control_.in; }

  void submit(UsbTransfer transfer) {
    pipe(transfer.endpoint).queue.push_back(std::move(transfer));
  }
  /// False: there is no such transfer any more.
  bool cancel(std::uint32_t id) {
    std::size_t cancelled = 0;
    for (Pipe& pipe : pipes_) {
      cancelled += std::erase_if(pipe.queue, [&](const auto& t) { return t.id == id; });
    }
    return cancelled != 0U;
  }
  std::deque<Ended> take_ended() { return std::exchange(ended_, {}); }

  /// Both sides begin with DATA0.
  void open() {
    configured_ = true;
    for (Pipe& pipe : pipes_) {
      pipe.toggle = 0;
      std::erase_if(pipe.queue, [](const auto& t) { return t.id == 0U && t.to_host(); });
    }
  }
  void write(const UsbBytes& bytes) { submit({0, core::usb::kBulkOut, bytes.size(), bytes, 0}); }
  [[nodiscard]] std::size_t unwritten() const {
    std::size_t bytes = 0;
    for (const UsbTransfer& transfer : pipes_[1].queue) {
      bytes += transfer.size - transfer.sent;
    }
    return bytes;
  }
  /// Of bulk reads that have ended.
  UsbBytes take_read() { return std::exchange(read_, {}); }
  UsbBytes take_news() { return std::exchange(news_, {}); }

  /// Returns false if nothing is to do.
  bool step() {
    for (int i = 0; i < 4; ++i) {
      next_ = (next_ + 1) % 4;
      if (next_ == 3 ? step_control() : step_pipe(pipes_[static_cast<std::size_t>(next_)])) {
        return true;
      }
    }
    return false;
  }

  std::string error;  ///< of a pipe without a transfer that could end with it
  std::uint64_t naks = 0;

 private:
  static constexpr std::size_t kReadBytes = 2048;
  static constexpr std::size_t kPacket = 64;
  enum class Stage : std::uint8_t { kSetup, kDataIn, kDataOut, kStatusIn, kStatusOut };

  struct Control {
    SetupPacket setup{};
    UsbBytes out{}, in{};
    Stage stage = Stage::kSetup;
    int toggle = 1;
    std::size_t sent = 0;
    int errors = 0;
    Result result = Result::kPending;
  };
  struct Pipe {
    std::uint8_t endpoint;
    std::size_t packet;
    std::size_t read_bytes;  // of a transfer of the host itself
    int toggle = 0;
    int silent = 0;
    std::deque<UsbTransfer> queue{};
  };

  bool lost() { return loses && random_() % 8U == 0U; }

  bool step_control() {
    if (control_.result != Result::kPending) {
      return false;
    }
    const Handshake handshake = transact_control();
    naks += handshake == Handshake::kNak ? 1U : 0U;
    if (handshake == Handshake::kStall) {
      control_.result = Result::kStalled;
    } else if (handshake == Handshake::kNone && ++control_.errors == 3) {
      control_.result = Result::kFailed;
    } else if (handshake == Handshake::kAck) {
      control_.errors = 0;
    }
    if (control_.result == Result::kDone) {
      clear_toggles(control_.setup);
    }
    return true;
  }
  void clear_toggles(const SetupPacket& setup) {
    using namespace core::usb;
    if ((setup.bmRequestType == 0x00 && setup.bRequest == kSetConfiguration) ||
        (setup.bmRequestType == 0x01 && setup.bRequest == kSetInterface)) {
      open();
    } else if (setup.bmRequestType == 0x02 && setup.bRequest == kClearFeature) {
      pipe(static_cast<std::uint8_t>(setup.wIndex)).toggle = 0;
    }
  }

  Handshake transact_control() {
    Control& c = control_;
    if (c.stage == Stage::kSetup) {
      std::array<std::uint8_t, 8> bytes{};
      std::memcpy(bytes.data(), &c.setup, bytes.size());
      const Handshake handshake = core_.setup(address, bytes);
      if (handshake == Handshake::kAck && !lost()) {
        c.stage = c.setup.wLength == 0U ? Stage::kStatusIn
                  : c.setup.to_host()   ? Stage::kDataIn
                                        : Stage::kDataOut;
      }
      return handshake;
    }
    if (c.stage == Stage::kDataIn || c.stage == Stage::kStatusIn) {
      return transact_control_in();
    }
    const bool status = c.stage == Stage::kStatusOut;
    const std::size_t size = status ? 0U : std::min(kPacket, c.out.size() - c.sent);
    const auto begin = c.out.begin() + static_cast<long>(c.sent);
    const Handshake handshake =
        core_.out(address, 0, status ? 1 : c.toggle, {begin, begin + static_cast<long>(size)});
    if (handshake == Handshake::kAck && !lost()) {
      c.toggle ^= 1;
      c.sent += size;
      if (status) {
        c.result = Result::kDone;
      } else if (c.sent == c.out.size()) {
        c.stage = Stage::kStatusIn;
      }
    }
    return handshake;
  }
  Handshake transact_control_in() {
    Control& c = control_;
    const bool status = c.stage == Stage::kStatusIn;
    const bool heard = !lost();
    const FakeUsbOtg::InReply reply = core_.in(address, 0, heard);
    if (reply.handshake != Handshake::kAck || reply.toggle != (status ? 1 : c.toggle)) {
      return reply.handshake;  // one that was sent again is dropped
    }
    if (status) {
      // Without its acknowledgement the device repeats it; the host does not wait for that.
      c.result = !reply.data.empty() ? Result::kFailed : heard ? Result::kDone : c.result;
      return reply.handshake;
    }
    c.toggle ^= 1;
    c.in.insert(c.in.end(), reply.data.begin(), reply.data.end());
    if (c.in.size() > c.setup.wLength) {
      c.result = Result::kFailed;  // babble
    }
    if (reply.data.size() < kPacket || c.in.size() == c.setup.wLength) {
      c.stage = Stage::kStatusOut;
    }
    return reply.handshake;
  }

  bool step_pipe(Pipe& pipe) {
    if (!configured_ || !error.empty()) {
      return false;
    }
    if (pipe.queue.empty() && pipe.read_bytes != 0U && reads) {
      pipe.queue.push_back({0, pipe.endpoint, pipe.read_bytes, {}, 0});
    }
    if (pipe.queue.empty()) {
      return false;
    }
    UsbTransfer& transfer = pipe.queue.front();
    if (transfer.id == 0U && transfer.to_host() && !reads) {
      return false;
    }
    bool ended = false;
    const Handshake handshake =
        transfer.to_host() ? step_in(pipe, transfer, ended) : step_out(pipe, transfer, ended);
    naks += handshake == Handshake::kNak ? 1U : 0U;
    pipe.silent = handshake == Handshake::kNone ? pipe.silent + 1 : 0;
    if (ended) {
      end(pipe, Result::kDone);
    } else if (handshake == Handshake::kStall) {
      end(pipe, Result::kStalled);
    } else if (pipe.silent == 3) {
      end(pipe, Result::kFailed);
    }
    return true;
  }
  Handshake step_in(Pipe& pipe, UsbTransfer& transfer, bool& ended) {
    const std::uint32_t number = pipe.endpoint & 0xFU;
    const FakeUsbOtg::InReply reply = core_.in(address, number, !lost());
    if (reply.handshake == Handshake::kAck && reply.toggle == pipe.toggle) {
      pipe.toggle ^= 1;
      transfer.bytes.insert(transfer.bytes.end(), reply.data.begin(), reply.data.end());
      ended = reply.data.size() < pipe.packet || transfer.bytes.size() >= transfer.size;
    }
    return reply.handshake;
  }
  Handshake step_out(Pipe& pipe, UsbTransfer& transfer, bool& ended) {
    const auto begin = transfer.bytes.begin() + static_cast<long>(transfer.sent);
    const std::size_t size = std::min(kPacket, transfer.size - transfer.sent);
    const Handshake handshake = core_.out(address, pipe.endpoint, pipe.toggle,
                                          UsbBytes(begin, begin + static_cast<long>(size)));
    if (handshake == Handshake::kAck && !lost()) {
      pipe.toggle ^= 1;
      transfer.sent += size;
      ended = transfer.sent == transfer.size;
    }
    return handshake;
  }
  void end(Pipe& pipe, Result result) {
    UsbTransfer& transfer = pipe.queue.front();
    if (transfer.id != 0U) {
      ended_.push_back({std::move(transfer), result});
    } else if (result != Result::kDone) {
      error = "endpoint " + std::to_string(pipe.endpoint & 0xFU) +
              (result == Result::kStalled ? " stalls" : " does not answer");
      return;
    } else if (transfer.to_host()) {
      UsbBytes& to = pipe.endpoint == core::usb::kBulkIn ? read_ : news_;
      to.insert(to.end(), transfer.bytes.begin(), transfer.bytes.end());
    }
    pipe.queue.pop_front();
  }

  Pipe& pipe(std::uint8_t endpoint) {
    return pipes_[endpoint == core::usb::kBulkIn ? 0U : endpoint == core::usb::kBulkOut ? 1U : 2U];
  }
  static std::array<Pipe, 3> make_pipes() {
    return {{{core::usb::kBulkIn, kPacket, kReadBytes},
             {core::usb::kBulkOut, kPacket, 0},
             {core::usb::kNewsIn, sizeof(core::usb::NewsPacket), sizeof(core::usb::NewsPacket)}}};
  }

  FakeUsbOtg& core_;
  Control control_{.result = Result::kFailed};
  std::array<Pipe, 3> pipes_ = make_pipes();
  std::deque<Ended> ended_;
  UsbBytes read_, news_;
  bool configured_ = false;
  int next_ = 0;
  std::minstd_rand random_{7};
};

}  // namespace tactree::test
