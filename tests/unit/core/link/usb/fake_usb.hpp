#pragma once
// A device controller, the host at its other end, and a memory for DFU: all in this process.

#include <algorithm>
#include <cstring>
#include <deque>
#include <optional>
#include <tuple>
#include <vector>

#include "tactree/hal/usb_device.hpp"

namespace tactree::usb_test {

using Bytes = std::vector<std::uint8_t>;

class FakeController {
 public:
  // What the device does.
  hal::UsbEvent next_event() {
    if (events.empty()) {
      return {};
    }
    const hal::UsbEvent event = events.front();
    events.pop_front();
    return event;
  }
  void control_send(std::span<const std::byte> data, bool) {
    sent.emplace(reinterpret_cast<const std::uint8_t*>(data.data()),
                 reinterpret_cast<const std::uint8_t*>(data.data()) + data.size());
  }
  void control_receive(std::uint16_t bytes) { wanted = bytes; }
  std::span<const std::byte> control_data() { return std::as_bytes(std::span(received)); }
  void control_acknowledge() {
    acknowledged = true;
    at_status = {address, open, halted};
  }
  void control_stall() { stalled = true; }
  void set_address(std::uint8_t value) { address = value; }
  void configure(bool on) {
    open = on;
    ++configurations;
  }
  void halt(std::uint8_t endpoint, bool on) {
    halted = on ? std::optional(endpoint) : std::nullopt;
  }
  std::size_t read(std::uint8_t endpoint, std::span<std::byte> bytes) {
    EXPECT_EQ(endpoint, core::usb::kBulkOut);
    const std::size_t count = std::min(bytes.size(), incoming.size());
    std::memcpy(bytes.data(), incoming.data(), count);
    incoming.erase(incoming.begin(), incoming.begin() + static_cast<long>(count));
    return count;
  }
  std::size_t write(std::uint8_t endpoint, std::span<const std::byte> bytes) {
    Bytes& to = endpoint == core::usb::kNewsIn ? news : outgoing;
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    to.insert(to.end(), data, data + bytes.size());
    return bytes.size();
  }

  std::deque<hal::UsbEvent> events;
  std::optional<Bytes> sent;
  std::optional<std::uint16_t> wanted;
  Bytes received;
  bool acknowledged = false;
  bool stalled = false;
  std::uint8_t address = 0;
  bool open = false;
  int configurations = 0;
  std::optional<std::uint8_t> halted;
  /// Address, open, halted, when the last status stage began.
  std::tuple<int, bool, std::optional<std::uint8_t>> at_status;
  Bytes incoming, outgoing, news;
};
static_assert(hal::UsbController<FakeController>);

/// Stores up to `capacity` bytes; returns the configured failures and delays.
class FakeStorage {
 public:
  core::usb::DfuStatus begin() {
    begun = true;
    written.clear();
    return at_begin;
  }
  core::usb::DfuStatus write(std::uint32_t offset, std::span<const std::byte> bytes) {
    EXPECT_TRUE(begun);
    EXPECT_EQ(offset, written.size());
    if (offset + bytes.size() > capacity) {
      return core::usb::DfuStatus::kAddress;
    }
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    written.insert(written.end(), data, data + bytes.size());
    busy_left = busy_per_block;
    return core::usb::DfuStatus::kOk;
  }
  core::usb::DfuStatus finish() {
    EXPECT_TRUE(begun);
    busy_left = busy_per_block;
    if (at_finish == core::usb::DfuStatus::kOk) {
      stored = written;
    }
    begun = false;
    return at_finish;
  }
  core::usb::DfuProgress progress() {
    if (busy_left > 0) {
      --busy_left;
      return {core::usb::DfuStatus::kOk, true, wait_ms};
    }
    return {at_progress, false, 0};
  }
  void abort() {
    begun = false;
    ++aborts;
  }
  core::usb::DfuStatus read(std::uint32_t offset, std::span<std::byte> bytes, std::size_t& count) {
    const std::size_t left = offset < stored.size() ? stored.size() - offset : 0;
    count = std::min(bytes.size(), left);
    if (count != 0) {
      std::memcpy(bytes.data(), stored.data() + offset, count);
    }
    return at_read;
  }

  Bytes stored, written;
  std::size_t capacity = 1U << 20U;
  bool begun = false;
  int aborts = 0;
  int busy_per_block = 0, busy_left = 0;
  std::uint32_t wait_ms = 5;
  core::usb::DfuStatus at_begin = core::usb::DfuStatus::kOk;
  core::usb::DfuStatus at_finish = core::usb::DfuStatus::kOk;
  core::usb::DfuStatus at_progress = core::usb::DfuStatus::kOk;
  core::usb::DfuStatus at_read = core::usb::DfuStatus::kOk;
};

/// What became of a control transfer: nothing when it was stalled.
using Reply = std::optional<Bytes>;

/// A device on a bus, and its host.
class Bus {
 public:
  void happen(hal::UsbEvent::Kind kind, core::usb::Speed speed = core::usb::Speed::kFull) {
    controller.events.push_back({kind, speed, {}});
    device.poll(now_us);
  }

  Reply control(const core::usb::SetupPacket& setup, const Bytes& data = {}) {
    controller.sent.reset();
    controller.wanted.reset();
    controller.acknowledged = controller.stalled = false;
    controller.events.push_back({hal::UsbEvent::Kind::kSetup, {}, setup});
    device.poll(now_us);
    if (controller.wanted) {
      controller.received = data;
      happen(hal::UsbEvent::Kind::kData);
    }
    if (controller.stalled) {
      return std::nullopt;
    }
    EXPECT_TRUE(controller.sent.has_value() != controller.acknowledged);
    return controller.sent.value_or(Bytes{});
  }
  Reply in(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
           std::uint16_t length) {
    return control({type, request, value, index, length});
  }
  Reply out(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
            const Bytes& data = {}) {
    return control({type, request, value, index, static_cast<std::uint16_t>(data.size())}, data);
  }
  void enumerate() {
    happen(hal::UsbEvent::Kind::kReset, core::usb::Speed::kHigh);
    ASSERT_TRUE(out(0x00, core::usb::kSetAddress, 5, 0));
    ASSERT_TRUE(out(0x00, core::usb::kSetConfiguration, 1, 0));
  }

  core::usb::Identity identity{.serial = {0x01234567, 0x89ABCDEF, 0x00C0FFEE}};
  FakeController controller;
  FakeStorage model, parameters;
  std::uint32_t now_us = 0;
  hal::UsbDevice<FakeController, FakeStorage, FakeStorage> device{controller, identity, true, model,
                                                                  parameters};
};

}  // namespace tactree::usb_test
