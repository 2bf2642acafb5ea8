// The board of firmware/boards/stm32f405 with a USB cable: the link of an application, models over
// DFU, and a cable that is unplugged at any time.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "analytic_shapes.hpp"
#include "board_rig.hpp"
#include "tactree/core/link/wire/frame.hpp"

namespace tactree::test {
namespace {

class Stm32f405Usb : public testing::Test {
 protected:
  Stm32f405Usb() { rig.program_image_model(sheet().bytes()); }
  ~Stm32f405Usb() override {
    FakeChip& chip = rig.chip();
    EXPECT_EQ(
        chip.clocks.violation + chip.serial.violation + chip.flash.violation + chip.usb.violation,
        "");
    EXPECT_EQ(rig.usb_accesses_of_ticks, 0U) << "a tick has accessed the USB core";
  }

  static const Shape& sheet() {
    static const Shape shape = sheet_below_hand();
    return shape;
  }
  static const Shape& small_sheet() {
    static const Shape shape = cos_sheet({}, 0.04, 0.002);
    return shape;
  }

  /// As dfu-util: DFU_DNLOAD and DFU_GETSTATUS until the last block, or for `blocks_max` blocks.
  /// The state of DFU; 0 if a request was refused.
  std::uint8_t download(std::span<const std::byte> file, std::uint16_t blocks_max = 10000) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(file.data());
    std::uint16_t block = 0;
    for (std::size_t at = 0;; at += core::usb::kDfuTransferBytes, ++block) {
      const std::size_t size =
          at < file.size() ? std::min<std::size_t>(core::usb::kDfuTransferBytes, file.size() - at)
                           : 0U;
      const UsbBytes piece(begin + std::min(at, file.size()),
                           begin + std::min(at, file.size()) + size);
      if (!rig.usb_request(
              {0x21, 1, block, core::usb::kModelInterface, static_cast<std::uint16_t>(size)},
              piece)) {
        return 0;
      }
      std::uint8_t state = dfu_state();
      while (state == 4U || state == 7U) {
        rig.run(wait_ms_);
        state = dfu_state();
      }
      if (size == 0U || state == 0U || state == 10U || block + 1 == blocks_max) {
        return state;
      }
    }
  }
  std::uint8_t dfu_state() {
    const bool good = rig.usb_request({0xA1, 3, 0, core::usb::kModelInterface, 6});
    const UsbBytes& status = rig.usb().answer();
    wait_ms_ = good ? status[1] | (status[2] << 8) : 0;
    return good ? status[4] : 0U;
  }
  [[nodiscard]] bool uses(const Shape& model) {
    return std::ranges::equal(rig.board().storage().active(), model.bytes());
  }

  BoardRig rig;

 private:
  int wait_ms_ = 0;
};

TEST_F(Stm32f405Usb, ConnectsWithItsPins) {
  rig.boot();
  EXPECT_TRUE(rig.chip().usb.connected());
  EXPECT_EQ(rig.chip().clocks.usb_MHz(), 48U);
  for (const std::uint32_t pin : {11U, 12U}) {
    EXPECT_EQ(rig.chip().gpio_a.mode(pin), 2U);
    EXPECT_EQ(rig.chip().gpio_a.function(pin), 10U);
  }
}

TEST_F(Stm32f405Usb, ReportsDeadController) {
  rig.chip().usb.resets = false;
  rig.boot();
  EXPECT_EQ(rig.ask_start().missing, static_cast<std::uint32_t>(core::wire::StartPart::kUsb));
  EXPECT_FALSE(rig.arm());
}

TEST_F(Stm32f405Usb, StaysDisconnectedWithoutCrystal) {
  rig.chip().clocks.crystal_MHz = 0;
  rig.boot();
  EXPECT_FALSE(rig.chip().usb.connected());
  EXPECT_EQ(rig.ask_start().missing, static_cast<std::uint32_t>(core::wire::StartPart::kCrystal));
}

// The serial number on USB is that of the chip, and the same as on the link.
TEST_F(Stm32f405Usb, StatesNumberOfChip) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    rig.chip().unique_id.word[i].value = 0x01020304U * (i + 1U);
  }
  rig.boot();
  ASSERT_TRUE(rig.plug_usb());
  ASSERT_TRUE(rig.usb_request({0x80, core::usb::kGetDescriptor, 0x0303, 0x0409, 255}));
  std::string text;
  for (std::size_t i = 2; i < rig.usb().answer().size(); i += 2) {
    text += static_cast<char>(rig.usb().answer()[i]);
  }
  EXPECT_EQ(text, "01020304020406080306090C");
  core::wire::IdentifyReply who;
  ASSERT_TRUE(rig.ask(core::wire::MessageKind::kIdentify).read(who));
  EXPECT_EQ(who.serial[2], 0x0306090CU);
}

TEST_F(Stm32f405Usb, GivesForceOverUsbUntilUnplugged) {
  rig.boot();
  ASSERT_TRUE(rig.plug_usb());
  ASSERT_TRUE(rig.arm()) << "faults " << rig.status().faults;
  EXPECT_TRUE(rig.touch());
  rig.run(1000);
  EXPECT_EQ(rig.status().state, core::State::kActive);
  EXPECT_TRUE(rig.feels());
  EXPECT_GT(rig.chip().usb.accesses, 0U);
  rig.unplug_usb();
  rig.application_runs = false;
  rig.run(60);
  EXPECT_EQ(rig.duty(), 0.0);
  EXPECT_EQ(rig.status().faults, core::fault_bit(core::Fault::kLinkLost));
  EXPECT_FALSE(rig.chip().watchdog.bitten());
}

// A board that stands alone keeps its force, whatever happens to the cable.
TEST_F(Stm32f405Usb, KeepsForceOfBoardThatStandsAloneWhenUnplugged) {
  rig.link_use = firmware::wiring::LinkUse::kWatches;
  rig.boot();
  rig.run(100);
  ASSERT_TRUE(rig.arm_by_button());
  ASSERT_TRUE(rig.touch());
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(rig.plug_usb());
    EXPECT_TRUE(rig.feels()) << "connected";
    ASSERT_TRUE(rig.open().ok());
    ASSERT_TRUE(
        rig.ask(core::wire::MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 1}).ok());
    EXPECT_EQ(rig.control(core::wire::ControlCode::kArm).status,
              core::wire::WireStatus::kWatchOnly);
    EXPECT_EQ(download(small_sheet().bytes()), 0U) << "the link may only watch";
    rig.unplug_usb();
    rig.run(100 + i);
    ASSERT_EQ(rig.status().state, core::State::kActive) << rig.status().faults;
    EXPECT_TRUE(rig.feels()) << "unplugged";
  }
  EXPECT_EQ(rig.status().overruns, 0U);
  EXPECT_TRUE(uses(sheet()));
}

// The recorder of the controller stands still after a fault; a notice has the tick all the same.
TEST_F(Stm32f405Usb, NotifiesOfEachChangeWithItsTick) {
  rig.boot();
  ASSERT_TRUE(rig.plug_usb());
  ASSERT_TRUE(rig.arm());
  rig.chip().press_stop(true);
  rig.run(200);
  rig.chip().press_stop(false);
  rig.run(100);
  (void)rig.usb().take_news();
  ASSERT_TRUE(rig.control(core::wire::ControlCode::kStop).ok());
  ASSERT_TRUE(rig.control(core::wire::ControlCode::kClearFault).ok());
  rig.run(10);
  const UsbBytes bytes = rig.usb().take_news();
  core::usb::NewsPacket news;
  ASSERT_EQ(bytes.size(), sizeof news);
  std::memcpy(&news, bytes.data(), sizeof news);
  EXPECT_EQ(news.state, static_cast<std::uint32_t>(rig.status().state));
  EXPECT_EQ(news.faults, 0U);
  EXPECT_GE(news.tick + 20U, rig.status().tick);
  EXPECT_LE(news.tick, rig.status().tick);
}

TEST_F(Stm32f405Usb, CableDoesNotDisturbSerialPort) {
  rig.boot();
  ASSERT_TRUE(rig.arm());
  ASSERT_TRUE(rig.plug_usb(true));
  rig.run(500);
  EXPECT_EQ(rig.status().state, core::State::kActive) << rig.status().faults;
  rig.unplug_usb();
  rig.run(500);
  EXPECT_EQ(rig.status().state, core::State::kActive) << rig.status().faults;
}

// While an application uses USB: a request at the serial port is not answered later.
TEST_F(Stm32f405Usb, ForgetsWhatSerialPortReceivesMeanwhile) {
  rig.boot();
  ASSERT_TRUE(rig.plug_usb());
  ASSERT_TRUE(rig.open().ok()) << "over USB";
  rig.application_runs = false;
  const auto kind = static_cast<std::uint8_t>(core::wire::MessageKind::kIdentify);
  std::array<std::byte, core::wire::kMaxEncodedFrame> frame{};
  const std::size_t size = core::wire::encode_frame({kind, 0, 1, 0, 0}, {}, frame);
  const auto request = [&] {
    for (const std::byte byte : std::span(frame).first(size)) {
      rig.to_board().push_back(static_cast<std::uint8_t>(byte));
    }
    rig.run(10);
  };
  (void)rig.take_sent();
  request();
  rig.unplug_usb();
  rig.run(60);
  EXPECT_TRUE(rig.take_sent().empty());
  request();
  EXPECT_FALSE(rig.take_sent().empty()) << "it is answered now";
}

TEST_F(Stm32f405Usb, ReturnsToSerialPort) {
  rig.boot();
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.plug_usb());
  ASSERT_TRUE(rig.open().ok()) << "over USB";
  for (int i = 0; i < 300; ++i) {
    rig.chip().serial.arrive(static_cast<std::uint8_t>(i));
  }
  rig.run(2);
  EXPECT_TRUE(rig.ask(core::wire::MessageKind::kState).ok());
  rig.unplug_usb();
  rig.run(10);
  ASSERT_TRUE(rig.open().ok()) << "over the serial port";
  EXPECT_TRUE(rig.ask(core::wire::MessageKind::kState).ok());
}

TEST_F(Stm32f405Usb, SendsTelemetryOfEveryTick) {
  rig.boot();
  ASSERT_TRUE(rig.plug_usb());
  ASSERT_TRUE(rig.arm());
  ASSERT_TRUE(
      rig.ask(core::wire::MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 1}).ok());
  rig.run(20);
  int messages = 0;
  rig.client().on_telemetry([&](const client::Telemetry&) { ++messages; });
  rig.run(1000);
  EXPECT_GE(messages, 999);
  EXPECT_TRUE(rig.usb_request({0x80, core::usb::kGetDescriptor, 0x0200, 0, 75}));
  EXPECT_EQ(rig.status().state, core::State::kActive) << rig.status().faults;
  ASSERT_TRUE(rig.control(core::wire::ControlCode::kStop).ok());
}

TEST_F(Stm32f405Usb, StoresModelByDfu) {
  rig.boot();
  ASSERT_TRUE(rig.plug_usb());
  EXPECT_EQ(download(small_sheet().bytes()), 2U);
  EXPECT_TRUE(uses(small_sheet()));
  EXPECT_FALSE(rig.chip().watchdog.bitten());
  EXPECT_EQ(rig.status().faults, 0U);
  ASSERT_TRUE(rig.arm());
  EXPECT_EQ(download(sheet().bytes()), 0U) << "while active";
  EXPECT_EQ(rig.status().state, core::State::kActive);
  rig.restart();
  EXPECT_TRUE(uses(small_sheet()));
}

// The cable is unplugged after every number of blocks: the old model stays, also for the next
// start.
TEST_F(Stm32f405Usb, KeepsModelWhenUnpluggedDuringDownload) {
  rig.boot();
  const std::size_t all = (small_sheet().bytes().size() + 511U) / 512U;
  for (std::uint16_t blocks = 1; blocks <= all; blocks += 3) {
    ASSERT_TRUE(rig.plug_usb());
    EXPECT_EQ(download(small_sheet().bytes(), blocks), 5U) << "ready for the next block";
    rig.unplug_usb();
    rig.run(20);
    EXPECT_TRUE(uses(sheet()));
  }
  ASSERT_TRUE(rig.plug_usb());
  EXPECT_EQ(download(small_sheet().bytes()), 2U);
  EXPECT_TRUE(uses(small_sheet()));
}

}  // namespace
}  // namespace tactree::test
