#pragma once
// What a host submits to a device, and what becomes of it, as text in the format of Linux's usbmon
// (Linux, Documentation/usb/usbmon.rst), but with all data: usbmon ends it after 32 bytes.

#include <cstdint>
#include <cstdio>
#include <istream>
#include <ostream>
#include <span>
#include <sstream>
#include <string>

#include "tactree/core/link/usb/setup.hpp"
#include "usb_host.hpp"

namespace tactree::test {

class UsbRecording {
 public:
  explicit UsbRecording(std::ostream& out) : out_(out) {}

  /// `setup`: of a control transfer; its bytes are those to the device.
  void submitted(const UsbTransfer& transfer, const core::usb::SetupPacket* setup) {
    begin(transfer, setup != nullptr ? setup->to_host() : transfer.to_host(), 'S');
    if (setup != nullptr) {
      std::array<char, 32> text{};
      (void)std::snprintf(text.data(), text.size(), " s %02x %02x %04x %04x %04x",
                          setup->bmRequestType, setup->bRequest, setup->wValue, setup->wIndex,
                          setup->wLength);
      out_ << text.data();
    } else {
      out_ << " -115";  // in progress
    }
    out_ << ' ' << transfer.size;
    end(transfer.bytes, setup != nullptr ? setup->to_host() : transfer.to_host());
  }
  void ended(const UsbTransfer& transfer, int status, std::size_t count,
             std::span<const std::uint8_t> data) {
    begin(transfer, transfer.to_host(), 'C');
    out_ << ' ' << status << ' ' << count;
    end(data, false);
  }

 private:
  void begin(const UsbTransfer& transfer, bool to_host, char what) {
    const unsigned number = transfer.endpoint & 0xFU;
    out_ << std::hex << transfer.id << std::dec << ' ' << ++events_ << ' ' << what << ' '
         << (number == 0U   ? 'C'
             : number == 1U ? 'B'
                            : 'I')
         << (to_host ? 'i' : 'o') << ":1:001:" << number;
  }
  void end(std::span<const std::uint8_t> data, bool to_host) {
    out_ << (to_host ? " <" : data.empty() ? "" : " =");
    for (std::size_t i = 0; i < data.size(); ++i) {
      std::array<char, 4> text{};
      (void)std::snprintf(text.data(), text.size(), "%02x", data[i]);
      out_ << (i % 4U == 0U ? " " : "") << text.data();
    }
    out_ << '\n';
  }

  std::ostream& out_;
  std::uint64_t events_ = 0;  // in place of a time
};

/// A line of a recording.
struct UsbRecorded {
  UsbTransfer transfer;  ///< of one that has ended: the bytes to the host
  core::usb::SetupPacket setup{};
  bool ended = false;
  int status = 0;  ///< of one that has ended
  [[nodiscard]] bool is_control() const { return (transfer.endpoint & 0xFU) == 0U; }
};

/// False: no such line.
inline bool read_recorded(const std::string& line, UsbRecorded& to) {
  std::istringstream in(line);
  std::uint64_t event = 0;
  std::string what, pipe, word;
  if (!(in >> std::hex >> to.transfer.id >> std::dec >> event >> what >> pipe) ||
      pipe.size() < 4U) {
    return false;
  }
  to.ended = what == "C";
  to.transfer.endpoint =
      static_cast<std::uint8_t>((pipe.back() - '0') | (pipe[1] == 'i' ? 0x80 : 0));
  if (!to.ended && pipe[0] == 'C') {
    std::array<unsigned, 5> setup{};
    in >> word >> std::hex;
    for (unsigned& part : setup) {
      in >> part;
    }
    in >> std::dec;
    to.setup = {static_cast<std::uint8_t>(setup[0]), static_cast<std::uint8_t>(setup[1]),
                static_cast<std::uint16_t>(setup[2]), static_cast<std::uint16_t>(setup[3]),
                static_cast<std::uint16_t>(setup[4])};
  } else {
    in >> to.status;
  }
  if (!(in >> to.transfer.size)) {
    return false;
  }
  in >> word;  // "=" or "<"
  while (in >> word) {
    for (std::size_t i = 0; i + 1U < word.size(); i += 2U) {
      to.transfer.bytes.push_back(
          static_cast<std::uint8_t>(std::stoul(word.substr(i, 2), nullptr, 16)));
    }
  }
  return true;
}

}  // namespace tactree::test
