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
#include <vector>

#include "fake_usb_otg.hpp"
#include "tactree/core/link/usb/descriptors.hpp"
#include "tactree/core/link/usb/setup.hpp"

namespace tactree::test {

class UsbHost {
 public:
  using SetupPacket = core::usb::SetupPacket;
  enum class Result : std::uint8_t { kPending, kDone, kStalled, kFailed };

  explicit UsbHost(FakeUsbOtg& core) : core_(core) {}

  // Behaviour.
  bool reads = true;          ///< asks for bulk data
  bool loses = false;         ///< every eighth handshake or so
  std::uint32_t address = 0;  ///< of the device

  /// Reset of the port. The host forgets its transfers.
  void begin_reset() {
    control_ = {};
    control_.result = Result::kFailed;
    out_.clear();
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

  /// After SET_CONFIGURATION or SET_INTERFACE: both sides begin with DATA0.
  void open() {
    configured_ = true;
    toggles_ = {};
    read_.clear();
    news_read_.clear();
  }
  void clear_toggle(std::uint8_t endpoint) { toggle_of(endpoint) = 0; }
  void write(const UsbBytes& bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  [[nodiscard]] std::size_t unwritten() const { return out_.size(); }
  /// Of bulk reads that have ended: with a short packet, or full.
  UsbBytes take_read() { return std::exchange(done_, {}); }
  UsbBytes take_news() { return std::exchange(news_, {}); }

  /// Returns false if nothing is to do.
  bool step() {
    for (int i = 0; i < 4; ++i) {
      next_ = (next_ + 1) % 4;
      const bool acted = next_ == 0   ? step_control()
                         : next_ == 1 ? step_read(1, done_, read_, kReadBytes, reads)
                         : next_ == 2
                             ? step_write()
                             : step_read(2, news_, news_read_, sizeof(core::usb::NewsPacket), true);
      if (acted) {
        return true;
      }
    }
    return false;
  }

  std::string error;  ///< of a bulk or interrupt pipe: the host would give up
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
    return true;
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

  bool step_read(std::uint32_t n, UsbBytes& done, UsbBytes& under_way, std::size_t size,
                 bool asks) {
    if (!configured_ || !asks || !error.empty()) {
      return false;
    }
    int& toggle = toggle_of(static_cast<std::uint8_t>(n | 0x80U));
    const FakeUsbOtg::InReply reply = core_.in(address, n, !lost());
    naks += reply.handshake == Handshake::kNak ? 1U : 0U;
    note(n, reply.handshake);
    if (reply.handshake == Handshake::kAck && reply.toggle == toggle) {
      toggle ^= 1;
      under_way.insert(under_way.end(), reply.data.begin(), reply.data.end());
      const std::size_t packet = n == 1U ? kPacket : 16U;
      if (reply.data.size() < packet || under_way.size() >= size) {
        done.insert(done.end(), under_way.begin(), under_way.end());
        under_way.clear();
      }
    }
    return true;
  }

  bool step_write() {
    if (!configured_ || out_.empty() || !error.empty()) {
      return false;
    }
    int& toggle = toggle_of(core::usb::kBulkOut);
    const auto size = static_cast<long>(std::min(kPacket, out_.size()));
    const Handshake handshake =
        core_.out(address, 1, toggle, UsbBytes(out_.begin(), out_.begin() + size));
    naks += handshake == Handshake::kNak ? 1U : 0U;
    note(1, handshake);
    if (handshake == Handshake::kAck && !lost()) {
      toggle ^= 1;
      out_.erase(out_.begin(), out_.begin() + size);
    }
    return true;
  }

  void note(std::uint32_t n, Handshake handshake) {
    silent_ = handshake == Handshake::kNone ? silent_ + 1 : 0;
    if (handshake == Handshake::kStall) {
      error = "endpoint " + std::to_string(n) + " stalls";
    } else if (silent_ == 3) {
      error = "endpoint " + std::to_string(n) + " does not answer";
    }
  }

  int& toggle_of(std::uint8_t endpoint) {
    return toggles_[endpoint == core::usb::kBulkIn    ? 0U
                    : endpoint == core::usb::kBulkOut ? 1U
                                                      : 2U];
  }

  FakeUsbOtg& core_;
  Control control_{.result = Result::kFailed};
  std::array<int, 3> toggles_{};
  std::deque<std::uint8_t> out_;
  UsbBytes read_, done_, news_read_, news_;
  bool configured_ = false;
  int next_ = 0;
  int silent_ = 0;
  std::minstd_rand random_{7};
};

}  // namespace tactree::test
