#pragma once
// The USB driver on the model of the OTG FS core, under the device of hal/usb_device.hpp, and a
// host.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <numeric>

#include "fake_usb.hpp"
#include "fake_usb_otg.hpp"
#include "stm32f4/usb_otg_fs.hpp"
#include "usb_host.hpp"

namespace tactree::test {

using core::usb::SetupPacket;
using usb_test::FakeStorage;
using Result = UsbHost::Result;
using Driver = firmware::stm32f4::UsbOtgFs<FakeWord>;

static_assert(hal::UsbController<Driver>);

inline constexpr std::uint8_t kIn = 0x80, kOut = 0x00, kToInterface = 0x01, kToEndpoint = 0x02;
inline constexpr std::uint8_t kClass = 0x20;

inline UsbBytes counting(std::size_t size, std::uint8_t first = 0) {
  UsbBytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), first);
  return bytes;
}

class UsbOtg : public testing::Test {
 protected:
  explicit UsbOtg(const core::usb::Identity& of = {.serial = {0x01234567, 0x89ABCDEF, 0x00C0FFEE}})
      : identity(of) {}
  ~UsbOtg() override { EXPECT_EQ(core->violation, ""); }

  /// The device works, then the host.
  void turn() {
    now_us += 50;
    device.poll(now_us);
    at_each_turn();
    for (int i = 0; i < tokens_per_turn; ++i) {
      (void)host.step();
    }
  }
  bool done() { return host.result() != Result::kPending; }
  Result control(const SetupPacket& setup, const UsbBytes& data = {}, int turns = 1000) {
    host.submit(setup, data);
    for (int i = 0; i < turns && !done(); ++i) {
      turn();
    }
    return host.result();
  }
  Result get(std::uint16_t descriptor, std::uint16_t length, std::uint16_t language = 0) {
    return control({kIn, core::usb::kGetDescriptor, descriptor, language, length});
  }
  void reset_bus() {
    host.begin_reset();
    for (int i = 0; i < 5; ++i) {
      turn();
    }
    host.end_reset();
    turn();
  }
  void set_address(std::uint8_t address) {
    ASSERT_EQ(control({kOut, core::usb::kSetAddress, address, 0, 0}), Result::kDone);
    host.address = address;
  }
  void set_configuration() {
    ASSERT_EQ(control({kOut, core::usb::kSetConfiguration, 1, 0, 0}), Result::kDone);
  }
  /// The requests of Linux 6.1 to a full-speed device.
  void enumerate() {
    reset_bus();
    ASSERT_EQ(get(0x0100, 64), Result::kDone);
    ASSERT_EQ(host.answer().size(), 18U);
    reset_bus();
    ASSERT_NO_FATAL_FAILURE(set_address(23));
    ASSERT_EQ(get(0x0100, 18), Result::kDone);
    const auto device_bytes = core::usb::device_descriptor(identity);
    EXPECT_EQ(std::memcmp(host.answer().data(), device_bytes.data(), 18), 0);
    ASSERT_EQ(get(0x0F00, 5), Result::kDone);
    ASSERT_EQ(get(0x0F00, core::usb::kBosBytes), Result::kDone);
    EXPECT_EQ(get(0x0600, 10), Result::kStalled) << "has no other speed";
    ASSERT_EQ(get(0x0200, 9), Result::kDone);
    ASSERT_EQ(host.answer().size(), 9U);
    const auto total = static_cast<std::uint16_t>(host.answer()[2] | (host.answer()[3] << 8));
    ASSERT_EQ(get(0x0200, total), Result::kDone);
    const auto all = core::usb::configuration_descriptor(core::usb::Speed::kFull);
    ASSERT_EQ(host.answer().size(), all.size());
    EXPECT_EQ(std::memcmp(host.answer().data(), all.data(), all.size()), 0);
    ASSERT_EQ(get(0x0300, 255), Result::kDone);
    for (const int string : {2, 1, 3}) {
      ASSERT_EQ(get(static_cast<std::uint16_t>(0x0300 | string), 255, 0x0409), Result::kDone);
      EXPECT_EQ(host.answer().size(), host.answer()[0]);
    }
    ASSERT_NO_FATAL_FAILURE(set_configuration());
    for (const int string : {4, 5, 6}) {
      ASSERT_EQ(get(static_cast<std::uint16_t>(0x0300 | string), 255, 0x0409), Result::kDone);
    }
    EXPECT_TRUE(device.configured());
  }
  void connect() {
    ASSERT_TRUE(driver.start());
    ASSERT_TRUE(core->connected());
    ASSERT_NO_FATAL_FAILURE(enumerate());
  }
  /// As libusb opens the interface of the link.
  void claim_link() {
    ASSERT_EQ(control({kToInterface, core::usb::kSetInterface, 0, core::usb::kLinkInterface, 0}),
              Result::kDone);
  }

  /// Bytes that the session sends; those that the port did not take stay.
  void send(UsbBytes& bytes) {
    const std::size_t taken = device.write(std::as_bytes(std::span(bytes)));
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<long>(taken));
  }
  UsbBytes receive() {
    std::array<std::uint8_t, 48> piece{};
    const std::size_t count = device.read(std::as_writable_bytes(std::span(piece)));
    return {piece.begin(), piece.begin() + static_cast<long>(count)};
  }

  /// As dfu-util does it. The state after the last block, or 0 after a refusal.
  std::uint8_t dfu_status(std::uint16_t interface) {
    const SetupPacket ask{kIn | kClass | kToInterface, 3, 0, interface, 6};
    return control(ask) == Result::kDone && host.answer().size() == 6U ? host.answer()[4] : 0U;
  }
  std::uint8_t download(std::uint16_t interface, const UsbBytes& file) {
    std::uint16_t block = 0;
    for (std::size_t at = 0;; at += 512U, ++block) {
      const std::size_t size = std::min<std::size_t>(512U, file.size() - std::min(at, file.size()));
      const UsbBytes piece(file.begin() + static_cast<long>(file.size() - (file.size() - at)),
                           file.begin() + static_cast<long>(at + size));
      const SetupPacket setup{kClass | kToInterface, 1, block, interface,
                              static_cast<std::uint16_t>(size)};
      if (control(setup, piece) != Result::kDone) {
        return 0;
      }
      std::uint8_t state = dfu_status(interface);
      while (state == 4U || state == 7U) {
        now_us += 5000;
        state = dfu_status(interface);
      }
      if (size == 0U || state == 0U) {
        return state;
      }
    }
  }
  UsbBytes upload(std::uint16_t interface) {
    UsbBytes all;
    for (std::uint16_t block = 0;; ++block) {
      if (control({kIn | kClass | kToInterface, 2, block, interface, 512}) != Result::kDone) {
        return {};
      }
      all.insert(all.end(), host.answer().begin(), host.answer().end());
      if (host.answer().size() < 512U) {
        return all;
      }
    }
  }

  int tokens_per_turn = 3;
  std::function<void()> at_each_turn = [] {};
  std::uint32_t now_us = 0;
  core::usb::Identity identity;
  std::unique_ptr<FakeUsbOtg> core = std::make_unique<FakeUsbOtg>();
  UsbHost host{*core};
  Driver driver{core->block};
  FakeStorage model, parameters;
  hal::UsbDevice<Driver, FakeStorage, FakeStorage> device{driver, identity, false, model,
                                                          parameters};
};

}  // namespace tactree::test
