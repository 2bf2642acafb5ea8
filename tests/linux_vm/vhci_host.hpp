#pragma once
// A full-speed port of the kernel's virtual host controller (module vhci-hcd): what the kernel
// submits becomes transactions of a UsbHost (Linux, Documentation/usb/usbip_protocol.rst).

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <list>
#include <span>
#include <stdexcept>

#include "usb_host.hpp"
#include "usb_recording.hpp"

namespace tactree::vm_test {

class VhciHost {
 public:
  explicit VhciHost(test::UsbHost& host) : host_(host) { host_.reads = false; }
  ~VhciHost() { unplug(); }

  /// What passes is also written there, if it is set.
  test::UsbRecording* recording = nullptr;

  void plug_in() {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw std::runtime_error("socketpair");
    }
    std::ofstream attach("/sys/devices/platform/vhci_hcd.0/attach");
    attach << "0 " << ends[1] << " 65536 2" << std::flush;  // port, socket, device, full speed
    if (!attach) {
      throw std::runtime_error("vhci_hcd: attach");
    }
    close(ends[1]);
    socket_ = ends[0];
    fcntl(socket_, F_SETFL, O_NONBLOCK);
    begin_reset();
  }
  void unplug() {
    if (socket_ >= 0) {
      close(std::exchange(socket_, -1));
    }
    incoming_.clear();
    urbs_.clear();
    (void)host_.take_ended();
  }
  [[nodiscard]] bool plugged_in() const { return socket_ >= 0; }

  /// The device works between two calls.
  void turn(int tokens) {
    receive();
    if (!plugged_in()) {
      return;
    }
    if (resetting_turns_ != 0 && --resetting_turns_ == 0) {
      host_.end_reset();
      // The virtual controller keeps the request SET_ADDRESS to itself.
      host_.submit({0, core::usb::kSetAddress, kAddress, 0, 0});
    }
    for (int i = 0; i < tokens && resetting_turns_ == 0; ++i) {
      begin_control();
      (void)host_.step();
      end_control();
    }
    for (const test::UsbHost::Ended& ended : host_.take_ended()) {
      finish(ended.transfer.id, ended.result,
             ended.transfer.to_host() ? ended.transfer.bytes.size() : ended.transfer.sent,
             ended.transfer.bytes);
    }
  }

 private:
  using Result = test::UsbHost::Result;
  static constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitReply = 3, kUnlinkReply = 4;
  static constexpr std::size_t kHeaderBytes = 48;
  static constexpr std::uint16_t kAddress = 1;
  using Words = std::array<std::uint32_t, kHeaderBytes / 4U>;

  /// A request of the kernel.
  struct Urb {
    test::UsbTransfer transfer;
    core::usb::SetupPacket setup;
    bool begun = false;
  };

  void begin_reset() {
    host_.begin_reset();
    resetting_turns_ = 5;
    addressed_ = false;
  }

  // ---- control transfers, one after another

  void begin_control() {
    if (!addressed_ || host_.result() == Result::kPending) {
      return;
    }
    const auto next = std::find_if(urbs_.begin(), urbs_.end(),
                                   [](const Urb& u) { return is_control(u) && !u.begun; });
    if (next != urbs_.end()) {
      next->begun = true;
      control_ = next->transfer.id;
      host_.submit(next->setup, next->transfer.bytes);
    }
  }
  void end_control() {
    if (host_.result() == Result::kPending) {
      return;
    }
    if (!addressed_) {
      if (host_.result() != Result::kDone) {
        begin_reset();
        return;
      }
      addressed_ = true;
      host_.address = kAddress;
    } else if (control_ != 0U) {
      const auto urb = find(std::exchange(control_, 0U));
      if (urb != urbs_.end()) {
        const bool to_host = urb->setup.to_host();
        const test::UsbBytes& bytes = to_host ? host_.answer() : urb->transfer.bytes;
        finish(urb->transfer.id, host_.result(),
               host_.result() == Result::kDone ? bytes.size() : 0U, bytes);
      }
    }
  }
  static bool is_control(const Urb& urb) { return (urb.transfer.endpoint & 0xFU) == 0U; }

  // ---- messages of USB/IP

  void receive() {
    std::array<std::uint8_t, 4096> piece{};
    while (socket_ >= 0) {
      const ssize_t count = recv(socket_, piece.data(), piece.size(), 0);
      if (count > 0) {
        incoming_.insert(incoming_.end(), piece.begin(), piece.begin() + count);
      } else if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
        break;
      } else {
        unplug();
      }
    }
    while (take_message()) {
    }
  }

  bool take_message() {
    if (incoming_.size() < kHeaderBytes) {
      return false;
    }
    Words words{};
    std::memcpy(words.data(), incoming_.data(), sizeof(words));
    std::transform(words.begin(), words.end(), words.begin(), ntohl);
    const bool to_host = words[3] != 0U;
    const std::size_t data = words[0] == kSubmit && !to_host ? words[6] : 0U;
    if (incoming_.size() < kHeaderBytes + data) {
      return false;
    }
    const auto begin = incoming_.begin() + kHeaderBytes;
    if (words[0] == kUnlink) {
      unlink(words[1], words[5]);
    } else {
      Urb urb;
      const auto endpoint = static_cast<std::uint8_t>(words[4] | (to_host ? 0x80U : 0U));
      urb.transfer = {words[1], endpoint, words[6], {begin, begin + static_cast<long>(data)}, 0};
      std::memcpy(&urb.setup, incoming_.data() + 40, sizeof(urb.setup));
      submit(urb);
    }
    incoming_.erase(incoming_.begin(), begin + static_cast<long>(data));
    return true;
  }

  void submit(const Urb& urb) {
    if (recording != nullptr) {
      recording->submitted(urb.transfer, is_control(urb) ? &urb.setup : nullptr);
    }
    urbs_.push_back(urb);
    if (!is_control(urb)) {
      host_.submit(urb.transfer);
    }
  }

  /// One that has ended is not cancelled.
  void unlink(std::uint32_t sequence, std::uint32_t which) {
    const auto urb = find(which);
    const bool there = urb != urbs_.end();
    if (there) {
      (void)host_.cancel(which);
      control_ = control_ == which ? 0U : control_;
      if (recording != nullptr) {
        recording->ended(urb->transfer, -ECONNRESET, 0, {});
      }
      urbs_.erase(urb);
    }
    reply(kUnlinkReply, sequence, there ? -ECONNRESET : 0, 0, {});
  }

  void finish(std::uint32_t id, Result result, std::size_t count, const test::UsbBytes& bytes) {
    const auto urb = find(id);
    if (urb == urbs_.end()) {
      return;
    }
    const int status = result == Result::kDone ? 0 : result == Result::kStalled ? -EPIPE : -EPROTO;
    const std::span<const std::uint8_t> data =
        urb->transfer.to_host() ? std::span(bytes).first(count) : std::span<const std::uint8_t>();
    if (recording != nullptr) {
      recording->ended(urb->transfer, status, count, data);
    }
    urbs_.erase(urb);
    reply(kSubmitReply, id, status, count, data);
  }

  void reply(std::uint32_t command, std::uint32_t sequence, int status, std::size_t count,
             std::span<const std::uint8_t> data) {
    Words words{};
    words[0] = htonl(command);
    words[1] = htonl(sequence);
    words[5] = htonl(static_cast<std::uint32_t>(status));
    words[6] = htonl(static_cast<std::uint32_t>(count));
    test::UsbBytes bytes(kHeaderBytes);
    std::memcpy(bytes.data(), words.data(), kHeaderBytes);
    bytes.insert(bytes.end(), data.begin(), data.end());
    for (std::size_t sent = 0; sent < bytes.size() && socket_ >= 0;) {
      const ssize_t count_now =
          send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count_now > 0) {
        sent += static_cast<std::size_t>(count_now);
      } else if (errno != EAGAIN && errno != EINTR) {
        return;  // receive() notices the end
      }
    }
  }

  std::list<Urb>::iterator find(std::uint32_t id) {
    return std::find_if(urbs_.begin(), urbs_.end(),
                        [&](const Urb& urb) { return urb.transfer.id == id; });
  }

  test::UsbHost& host_;
  int socket_ = -1;
  int resetting_turns_ = 0;
  bool addressed_ = false;
  std::uint32_t control_ = 0;  // under way
  test::UsbBytes incoming_;
  std::list<Urb> urbs_;
};

}  // namespace tactree::vm_test
