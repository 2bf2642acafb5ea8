// The USB driver on the model of the OTG FS core: what a Linux host was recorded to submit, and the
// same answers to it.

#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "usb_otg_rig.hpp"
#include "usb_recording.hpp"

namespace tactree::test {
namespace {

/// Linux, libusb, lsusb and dfu-util, in this order (scripts/record-usb-host). `tactree` connects,
/// identifies the board, subscribes to telemetry, arms and stops it; dfu-util reads the model and
/// writes it again.
constexpr char kLinuxHost[] =
#include "linux_host.usbmon"
    ;  // NOLINT

struct Bus {
  int tokens_per_turn;
  bool loses;
};

class RecordedHost : public UsbOtg, public testing::WithParamInterface<Bus> {
 protected:
  static constexpr int kTurnsMax = 2000;
  static constexpr int kCancelled = -104;  // ECONNRESET
  static constexpr int kStalled = -32;     // EPIPE

  RecordedHost() : UsbOtg({.serial = {0x11111111, 0x22222222, 0x33333333}}) {
    std::istringstream lines(kLinuxHost);
    for (std::string line; std::getline(lines, line);) {
      UsbRecorded event;
      if (read_recorded(line, event)) {
        if (event.ended) {
          answers[event.transfer.id] = event;
        }
        events.push_back(std::move(event));
      }
    }
    model.wait_ms = 1;
    model.stored = first_upload();
    host.reads = false;
    host.loses = GetParam().loses;
    tokens_per_turn = GetParam().tokens_per_turn;
    at_each_turn = [this] {
      const UsbBytes came = receive();
      received.insert(received.end(), came.begin(), came.end());
    };
  }

  [[nodiscard]] static bool is_dfu(const SetupPacket& setup, std::uint8_t request) {
    return setup.bmRequestType == (kIn | kClass | kToInterface) && setup.bRequest == request &&
           setup.wIndex == core::usb::kModelInterface;
  }
  UsbBytes first_upload() {
    UsbBytes model_bytes;
    for (const UsbRecorded& event : events) {
      if (!event.ended && is_dfu(event.setup, 2)) {
        const UsbBytes& piece = answers[event.transfer.id].transfer.bytes;
        model_bytes.insert(model_bytes.end(), piece.begin(), piece.end());
        if (piece.size() < event.transfer.size) {
          break;
        }
      }
    }
    return model_bytes;
  }

  void begin(const UsbRecorded& event) {
    if (!event.is_control()) {
      host.submit(event.transfer);
      if (!event.transfer.to_host()) {
        to_receive.insert(to_receive.end(), event.transfer.bytes.begin(),
                          event.transfer.bytes.end());
      }
      return;
    }
    ASSERT_TRUE(done()) << "Linux submits one after another";
    if (is_dfu(event.setup, 3)) {  // DFU_GETSTATUS: the store was as busy as it was
      const UsbBytes& status = answers[event.transfer.id].transfer.bytes;
      model.busy_left =
          status.at(4) == static_cast<int>(core::usb::DfuState::kDownloadBusy) ? 1 : 0;
      now_us += 1000;
    }
    host.submit(event.setup, event.transfer.bytes);
  }

  void end(const UsbRecorded& event) {
    const UsbTransfer& transfer = event.transfer;
    if (event.status == kCancelled) {
      EXPECT_TRUE(host.cancel(transfer.id));
    } else if (event.is_control()) {
      for (int i = 0; i < kTurnsMax && !done(); ++i) {
        turn();
      }
      ASSERT_EQ(host.result(), event.status == kStalled ? Result::kStalled : Result::kDone);
      EXPECT_EQ(host.answer(), transfer.bytes);
    } else {
      ASSERT_EQ(event.status, 0);
      end_pipe(transfer);
    }
  }
  void end_pipe(const UsbTransfer& recorded) {
    UsbBytes left = recorded.bytes;  // the session's
    for (int i = 0; i < kTurnsMax && ended.empty(); ++i) {
      const std::size_t taken = driver.write(recorded.endpoint, std::as_bytes(std::span(left)));
      left.erase(left.begin(), left.begin() + static_cast<long>(taken));
      turn();
      for (auto& transfer : host.take_ended()) {
        ended.push_back(std::move(transfer));
      }
    }
    ASSERT_FALSE(ended.empty());
    EXPECT_EQ(ended.front().result, Result::kDone);
    EXPECT_EQ(ended.front().transfer.id, recorded.id);
    if (recorded.to_host()) {
      EXPECT_EQ(ended.front().transfer.bytes, recorded.bytes);
    }
    ended.pop_front();
  }

  std::vector<UsbRecorded> events;
  std::map<std::uint32_t, UsbRecorded> answers;
  std::deque<UsbHost::Ended> ended;
  UsbBytes received, to_receive;
};

TEST_P(RecordedHost, GetsSameAnswers) {
  ASSERT_GT(events.size(), 200U);
  ASSERT_TRUE(driver.start());
  reset_bus();
  ASSERT_NO_FATAL_FAILURE(set_address(1));
  const UsbBytes file = model.stored;
  ASSERT_GT(file.size(), 512U);
  for (const UsbRecorded& event : events) {
    SCOPED_TRACE(event.transfer.id);
    ASSERT_NO_FATAL_FAILURE(event.ended ? end(event) : begin(event));
  }
  EXPECT_EQ(received, to_receive);
  EXPECT_EQ(model.written, file) << "the download";
  EXPECT_FALSE(model.begun);
}

INSTANTIATE_TEST_SUITE_P(Buses, RecordedHost,
                         testing::Values(Bus{1, false}, Bus{3, true}, Bus{19, false},
                                         Bus{19, true}),
                         [](const auto& instance) {
                           return std::to_string(instance.param.tokens_per_turn) + "Tokens" +
                                  (instance.param.loses ? "Lossy" : "");
                         });

}  // namespace
}  // namespace tactree::test
