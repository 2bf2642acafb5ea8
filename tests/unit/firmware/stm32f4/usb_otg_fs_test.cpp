// The USB driver on the model of the OTG FS core: what a Linux host, libusb and dfu-util send.

#include "stm32f4/usb_otg_fs.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tactree/core/link/wire/frame.hpp"
#include "tactree/core/link/wire/telemetry.hpp"
#include "usb_otg_rig.hpp"

namespace tactree::test {
namespace {

TEST_F(UsbOtg, StaysDisconnectedWithFailedCore) {
  const std::function<void(FakeUsbOtg&)> cases[] = {
      [](FakeUsbOtg& f) { f.gate_by([] { return false; }); },
      [](FakeUsbOtg& f) { f.resets = false; },
      [](FakeUsbOtg& f) { f.reaches_device = false; },
  };
  for (const auto& break_it : cases) {
    const auto broken = std::make_unique<FakeUsbOtg>();
    break_it(*broken);
    Driver dead(broken->block);
    EXPECT_FALSE(dead.start());
    EXPECT_FALSE(broken->connected());
    const std::uint64_t before = broken->accesses;
    EXPECT_EQ(dead.next_event().kind, hal::UsbEvent::Kind::kNone);
    EXPECT_EQ(broken->accesses, before);
  }
}

TEST_F(UsbOtg, AnswersEnumerationOfLinux) { connect(); }

TEST_F(UsbOtg, AnswersWindows) {
  connect();
  ASSERT_EQ(control({0xC0, core::usb::kMicrosoftRequest, 0, 7, 0x1000}), Result::kDone);
  const auto all = core::usb::microsoft_descriptors();
  ASSERT_EQ(host.answer().size(), all.size());
  EXPECT_EQ(std::memcmp(host.answer().data(), all.data(), all.size()), 0);
}

// A data stage of whole packets, shorter than the host asked for, ends with an empty one.
TEST_F(UsbOtg, EndsDataStageOfWholePackets) {
  connect();
  model.stored = counting(128);
  EXPECT_EQ(upload(core::usb::kModelInterface), counting(128));
  model.stored = {};
  EXPECT_EQ(upload(core::usb::kModelInterface), UsbBytes{});
  EXPECT_EQ(device.model().state(), core::usb::DfuState::kIdle);
}

TEST_F(UsbOtg, SendsNothingAfterShortPacket) {
  connect();
  host.submit({kIn, core::usb::kGetDescriptor, 0x0100, 0, 64});
  while (host.answer().size() < 18U) {
    device.poll(now_us);
    (void)host.step();
  }
  for (int i = 0; i < 3; ++i) {
    device.poll(now_us);
    EXPECT_EQ(core->in(host.address, 0).handshake, Handshake::kNak);
  }
}

TEST_F(UsbOtg, CarriesLinkInBothDirections) {
  connect();
  claim_link();
  for (const bool loses : {false, true}) {
    host.loses = loses;
    for (const std::size_t size : {1U, 3U, 63U, 64U, 65U, 128U, 279U, 512U, 1116U}) {
      UsbBytes to_host = counting(size, 3);
      host.write(counting(size, 7));
      UsbBytes there, here;
      for (int i = 0; i < 2000 && (there.size() < size || here.size() < size); ++i) {
        send(to_host);
        const UsbBytes came = receive();
        here.insert(here.end(), came.begin(), came.end());
        turn();
        const UsbBytes read = host.take_read();
        there.insert(there.end(), read.begin(), read.end());
      }
      ASSERT_EQ(there, counting(size, 3)) << "a read of the host ends with a short packet only";
      ASSERT_EQ(here, counting(size, 7));
    }
  }
  EXPECT_EQ(host.error, "");
}

// A client that opens the link again begins with DATA0 on both sides.
TEST_F(UsbOtg, ClearsTogglesForEachClient) {
  connect();
  for (std::uint8_t client = 0; client < 5; ++client) {
    claim_link();
    ASSERT_EQ(receive(), UsbBytes{});
    UsbBytes hello(1, client);
    send(hello);
    host.write(UsbBytes(1, client));
    for (int i = 0; i < 20; ++i) {
      turn();
    }
    EXPECT_EQ(host.take_read(), UsbBytes(1, client));
    EXPECT_EQ(receive(), UsbBytes(1, client));
  }
  EXPECT_EQ(host.error, "");
}

TEST_F(UsbOtg, DropsUnreadBytesForNextClient) {
  connect();
  claim_link();
  host.reads = false;
  UsbBytes old = counting(300);
  send(old);
  host.write(counting(40));
  for (int i = 0; i < 20; ++i) {
    turn();
  }
  claim_link();
  host.reads = true;
  EXPECT_EQ(receive(), UsbBytes{});
  UsbBytes hello = counting(5);
  send(hello);
  for (int i = 0; i < 20; ++i) {
    turn();
  }
  EXPECT_EQ(host.take_read(), counting(5));
}

TEST_F(UsbOtg, SendsNewsOncePerChange) {
  connect();
  core::Status status;
  status.state = core::State::kIdle;
  for (int i = 0; i < 20; ++i) {
    device.send_changes(status);
    turn();
  }
  const UsbBytes news = host.take_news();
  ASSERT_EQ(news.size(), sizeof(core::usb::NewsPacket));
  EXPECT_EQ(news[4], static_cast<std::uint8_t>(core::State::kIdle));
}

TEST_F(UsbOtg, StallsAndRecovers) {
  connect();
  EXPECT_EQ(control({kIn, 99, 0, 0, 64}), Result::kStalled);
  EXPECT_EQ(control({kOut, core::usb::kSetConfiguration, 9, 0, 0}), Result::kStalled);
  EXPECT_EQ(control({kClass | kToInterface, 1, 0, 2, 600}, counting(600)), Result::kStalled);
  ASSERT_EQ(get(0x0100, 18), Result::kDone);

  for (const std::uint8_t endpoint : {core::usb::kBulkIn, core::usb::kBulkOut}) {
    claim_link();
    UsbBytes first = counting(1);  // a packet: the next one has DATA1
    send(first);
    host.write(counting(1));
    for (int i = 0; i < 10; ++i) {
      turn();
    }
    EXPECT_EQ(host.take_read(), counting(1));
    EXPECT_EQ(receive(), counting(1));
    host.reads = false;
    UsbBytes bytes = counting(100);
    send(bytes);
    ASSERT_EQ(control({kToEndpoint, core::usb::kSetFeature, 0, endpoint, 0}), Result::kDone);
    host.reads = true;
    host.write(counting(1));
    for (int i = 0; i < 10; ++i) {
      turn();
    }
    EXPECT_NE(host.error.find("stalls"), std::string::npos);
    ASSERT_EQ(control({kToEndpoint, core::usb::kClearFeature, 0, endpoint, 0}), Result::kDone);
    host.error = "";
    for (int i = 0; i < 10; ++i) {
      turn();
      (void)receive();
    }
    if (endpoint == core::usb::kBulkIn) {
      EXPECT_EQ(host.take_read(), UsbBytes{}) << "what was not sent before the halt";
    }
    (void)host.take_read();
    UsbBytes after = counting(9);
    send(after);
    for (int i = 0; i < 10; ++i) {
      turn();
    }
    EXPECT_EQ(host.take_read(), counting(9));
    EXPECT_EQ(host.error, "");
    EXPECT_EQ(host.unwritten(), 0U);
  }
}

// ---- DFU

TEST_F(UsbOtg, TransfersModelByDfu) {
  connect();
  const UsbBytes file = counting(5 * 512 + 77);
  for (const bool loses : {false, true}) {
    host.loses = loses;
    model.busy_per_block = 2;
    EXPECT_EQ(download(core::usb::kModelInterface, file), 2U);
    EXPECT_EQ(model.stored, file);
    EXPECT_EQ(upload(core::usb::kModelInterface), file);
    parameters.stored = counting(512);
    EXPECT_EQ(upload(core::usb::kParameterInterface), counting(512));
  }
}

TEST_F(UsbOtg, TransfersModelBesideTelemetry) {
  connect();
  claim_link();
  const UsbBytes file = counting(3 * 512);
  UsbBytes telemetry = counting(3000);
  at_each_turn = [&] { send(telemetry); };
  EXPECT_EQ(download(core::usb::kModelInterface, file), 2U);
  EXPECT_EQ(model.stored, file);
  EXPECT_EQ(host.take_read(), counting(3000));
}

// A telemetry message of all fields in each millisecond, as of a loop at 1 kHz whose ticks leave
// time for two calls of the session, while the host also sends control requests. At full speed a
// frame of the bus has time for 19 packets of 64 bytes (USB 2.0, table 5-9).
TEST_F(UsbOtg, SendsTelemetryEachMillisecond) {
  connect();
  claim_link();
  constexpr int kMilliseconds = 1000;
  constexpr int kCallsPerMillisecond = 2;
  constexpr int kPacketsPerCall = 19 / kCallsPerMillisecond;
  std::array<std::byte, core::wire::kMaxTelemetry> payload{};
  std::array<std::byte, core::wire::kMaxEncodedFrame> frame{};
  UsbBytes queue;
  std::size_t longest = 0, total = 0, frames = 0, requests = 0;
  for (int ms = 0; ms < kMilliseconds; ++ms) {
    payload[0] = static_cast<std::byte>(ms);
    const std::size_t size = core::wire::encode_frame({0x40, 0, 0, 0, 0}, payload, frame);
    ASSERT_GT(size, 0U);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(frame.data());
    queue.insert(queue.end(), bytes, bytes + size);
    total += size;
    for (int call = 0; call < kCallsPerMillisecond; ++call) {
      device.poll(now_us);
      send(queue);
      for (int i = 0; i < kPacketsPerCall; ++i) {
        (void)host.step();
      }
      if (done()) {
        ++requests;
        host.submit({kIn, core::usb::kGetDescriptor, 0x0200, 0, 75});
      }
    }
    longest = std::max(longest, queue.size());
  }
  const UsbBytes read = host.take_read();
  frames = static_cast<std::size_t>(std::count(read.begin(), read.end(), 0));
  RecordProperty("bytes_per_ms", static_cast<int>(total / kMilliseconds));
  EXPECT_GE(frames + 2U, static_cast<std::size_t>(kMilliseconds));
  EXPECT_LE(longest, core::wire::kMaxEncodedFrame) << "messages wait";
  EXPECT_GT(requests, 50U);
}

}  // namespace
}  // namespace tactree::test
