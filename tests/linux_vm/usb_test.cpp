// The simulated board as a USB device of a real kernel, and libusb's side of it. Runs as root in
// the test kernel only: it plugs a device into the machine it runs on.

#include <libusb.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include "board_on_usb.hpp"

namespace tactree::vm_test {
namespace {

using core::wire::MessageKind;

template <class Port>
class Usb : public testing::Test {};
using Ports = testing::Types<UsbIpPort, OtgPort>;
TYPED_TEST_SUITE(Usb, Ports);

TYPED_TEST(Usb, ListsNameAndSerialNumber) {
  const BoardOnUsb<TypeParam> board;
  std::vector<client::UsbDeviceInfo> devices;
  ASSERT_TRUE(eventually([&] {
    devices = client::list_usb_devices();
    return devices.size() == 1;
  }));
  EXPECT_EQ(devices[0].serial, "111111112222222233333333");
  EXPECT_EQ(devices[0].maker, "Tactree");
  EXPECT_EQ(devices[0].name, "Haptic controller");
  EXPECT_EQ(devices[0].problem, "");
}

TYPED_TEST(Usb, WindowsFindsItsDescriptors) {
  const BoardOnUsb<TypeParam> board;
  const auto opened = open_board();
  ASSERT_TRUE(opened);
  libusb_context* context = nullptr;
  ASSERT_EQ(libusb_init(&context), 0);
  libusb_device_handle* device = libusb_open_device_with_vid_pid(context, 0x1209, 0x0001);
  ASSERT_NE(device, nullptr);
  libusb_bos_descriptor* bos = nullptr;
  ASSERT_EQ(libusb_get_bos_descriptor(device, &bos), 0);
  ASSERT_EQ(bos->bNumDeviceCaps, 1);
  const auto* platform = reinterpret_cast<const std::uint8_t*>(bos->dev_capability[0]);
  EXPECT_EQ(platform[2], 5);
  std::array<unsigned char, 1024> set{};
  const int length = libusb_control_transfer(device, 0xC0, platform[26], 0, 7, set.data(),
                                             static_cast<std::uint16_t>(set.size()), 60000);
  EXPECT_EQ(length, static_cast<int>(core::usb::kMicrosoftBytes));
  EXPECT_EQ(libusb_control_transfer(device, 0xC0, platform[26], 0, 9, set.data(), 64, 60000),
            LIBUSB_ERROR_PIPE);
  libusb_free_bos_descriptor(bos);
  libusb_close(device);
  libusb_exit(context);
}

TYPED_TEST(Usb, HaltedEndpointResumesWhenCleared) {
  const BoardOnUsb<TypeParam> board;
  auto transport = open_board();
  ASSERT_TRUE(transport);
  transport.reset();
  libusb_context* context = nullptr;
  ASSERT_EQ(libusb_init(&context), 0);
  libusb_device_handle* device = libusb_open_device_with_vid_pid(context, 0x1209, 0x0001);
  ASSERT_NE(device, nullptr);
  ASSERT_EQ(libusb_claim_interface(device, 0), 0);
  ASSERT_EQ(libusb_control_transfer(device, 0x02, LIBUSB_REQUEST_SET_FEATURE, 0,
                                    core::usb::kBulkOut, nullptr, 0, 60000),
            0);
  std::array<unsigned char, 8> bytes{};
  int moved = 0;
  EXPECT_EQ(libusb_bulk_transfer(device, core::usb::kBulkOut, bytes.data(), 8, &moved, 60000),
            LIBUSB_ERROR_PIPE);
  EXPECT_EQ(libusb_clear_halt(device, core::usb::kBulkOut), 0);
  EXPECT_EQ(libusb_bulk_transfer(device, core::usb::kBulkOut, bytes.data(), 8, &moved, 60000), 0);
  EXPECT_EQ(moved, 8);
  libusb_close(device);
  libusb_exit(context);
}

TYPED_TEST(Usb, RefusesSecondProgram) {
  const BoardOnUsb<TypeParam> board;
  const auto first = open_board();
  ASSERT_TRUE(first);
  try {
    (void)client::open_usb("");
    FAIL() << "opened twice";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("end the other program"), std::string::npos)
        << error.what();
  }
}

TYPED_TEST(Usb, MissingPermissionNamesUdevRule) {
  const BoardOnUsb<TypeParam> board;
  ASSERT_TRUE(open_board());
  const pid_t child = fork();
  if (child == 0) {
    const bool other = setgid(65534) == 0 && setuid(65534) == 0;
    const auto devices = client::list_usb_devices();
    const bool told = other && devices.size() == 1 &&
                      devices[0].problem.find(client::udev_rule()) != std::string::npos;
    _exit(told ? 0 : 1);
  }
  int status = 1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(NoUsb, NamesMissingBoard) {
  try {
    (void)client::open_usb("ABCD");
    FAIL() << "opened what is not there";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no board is plugged in"), std::string::npos);
  }
}

TYPED_TEST(Usb, MeasuresRoundTrip) {
  const BoardOnUsb<TypeParam> board;
  Application application(open_board());
  ASSERT_TRUE(application.open().ok());
  std::vector<double> took_ms;
  for (int i = 0; i < 500; ++i) {
    const Clock::time_point begin = Clock::now();
    ASSERT_TRUE(application.ask(MessageKind::kIdentify).ok());
    took_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  std::sort(took_ms.begin(), took_ms.end());
  std::printf("round trip: p50 %.2f ms, p99 %.2f ms, of %zu\n", took_ms[took_ms.size() / 2],
              took_ms[took_ms.size() * 99 / 100], took_ms.size());
}

/// Each tick has a message; one that does not come was counted by the board.
TYPED_TEST(Usb, CountsLostTelemetry) {
  const BoardOnUsb<TypeParam> board(std::chrono::microseconds(0));
  Application application(open_board());
  ASSERT_TRUE(application.open().ok());
  std::uint64_t received = 0;
  std::uint64_t unnoticed = 0;
  std::uint32_t last_tick = 0;
  std::uint32_t last_dropped = 0;
  application.client().on_telemetry([&](const client::Telemetry& telemetry) {
    const auto& header = telemetry.header;
    if (received++ != 0) {
      const std::uint32_t missing = header.tick - last_tick - 1;
      const std::uint32_t told = header.dropped - last_dropped;
      unnoticed += missing > told ? missing - told : 0;
    }
    last_tick = header.tick;
    last_dropped = header.dropped;
  });
  ASSERT_TRUE(
      application.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 1}).ok());
  constexpr std::uint64_t kPacketBytes = 64;  // bulk, at full speed
  constexpr std::uint64_t kWanted = TypeParam::kHighSpeed ? 1'000'000 : 100'000;  // a slow model
  const Clock::time_point begin = Clock::now();
  Clock::time_point progress = begin;
  while (application.received() < kPacketBytes * kWanted && Clock::now() - progress < kPatience) {
    const std::uint64_t before = received;
    application.turn();
    progress = received != before ? Clock::now() : progress;
  }
  EXPECT_GE(application.received(), kPacketBytes * kWanted);
  EXPECT_EQ(unnoticed, 0U);
  EXPECT_EQ(application.client().damaged(), 0U);
  std::printf(
      "telemetry: %llu messages, %u dropped and reported, %llu unnoticed, %llu bytes, %.0f s\n",
      static_cast<unsigned long long>(received), last_dropped,
      static_cast<unsigned long long>(unnoticed),
      static_cast<unsigned long long>(application.received()),
      std::chrono::duration<double>(Clock::now() - begin).count());
}

TYPED_TEST(Usb, NotifiesOfStateChanges) {
  const BoardOnUsb<TypeParam> board;
  Application application(open_board());
  ASSERT_TRUE(application.open().ok());
  std::vector<std::uint32_t> states;
  const auto listen = [&] {
    application.turn();
    if (const auto news = application.transport().take_news()) {
      states.push_back(news->state);
    }
  };
  using core::wire::ControlCode;
  const auto control = [&](ControlCode code) {
    return application.ask(MessageKind::kControl,
                           core::wire::ControlRequest{static_cast<std::uint8_t>(code), {}, 0});
  };
  ASSERT_TRUE(control(ControlCode::kArm).ok());
  const auto armed = static_cast<std::uint32_t>(core::State::kArmed);
  EXPECT_TRUE(eventually([&] {
    listen();
    return !states.empty() && states.back() == armed;
  }));
  ASSERT_TRUE(control(ControlCode::kStop).ok());
  EXPECT_TRUE(eventually([&] {
    listen();
    return states.back() != armed;
  }));
}

/// Unplugs the board when idle, during a request, telemetry, a half-written request.
TYPED_TEST(Usb, SurvivesUnplugAtAnyMoment) {
  BoardOnUsb<TypeParam> board;
  std::mt19937 random(1);
  for (int round = 0; round < 24; ++round) {
    board.plug(true);
    Application application(open_board());
    ASSERT_TRUE(application.open().ok()) << "round " << round;
    if (round % 4 >= 2) {
      ASSERT_TRUE(
          application.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 1}).ok());
    }
    if (round % 2 == 1) {
      application.client().send(MessageKind::kIdentify, std::span<const std::byte>(),
                                Application::now_us());
    }
    if (round % 4 == 3) {
      const std::array<std::byte, 3000> garbage{std::byte{1}};
      (void)application.transport().write(garbage);
    }
    const auto turns = static_cast<std::uint32_t>(random() % 20);
    for (std::uint32_t i = 0; i < turns; ++i) {
      application.turn(std::chrono::microseconds(200));
    }
    const std::uint64_t before = board.ticks();
    board.plug(false);
    EXPECT_TRUE(eventually([&] {
      application.turn();
      return !application.transport().connected();
    })) << "round "
        << round;
    EXPECT_NE(application.transport().reason(), "");
    std::array<std::byte, 16> bytes{};
    EXPECT_EQ(application.transport().write(bytes), 0U);
    EXPECT_TRUE(eventually([&] { return board.ticks() > before + 2; })) << "the loop went on";
  }
}

TYPED_TEST(Usb, ReportsHotplugWithoutUdev) {
  BoardOnUsb<TypeParam> board;
  client::UsbWatch watch(std::chrono::milliseconds(20));
  const auto wait_for = [&](bool arrived) {
    return eventually([&] {
      const auto changes = watch.poll();
      return std::any_of(changes.begin(), changes.end(), [&](const auto& change) {
        return change.arrived == arrived && (!arrived || !change.device.serial.empty());
      });
    });
  };
  EXPECT_TRUE(wait_for(true));
  board.plug(false);
  EXPECT_TRUE(wait_for(false));
  EXPECT_TRUE(watch.devices().empty());
  board.plug(true);
  EXPECT_TRUE(wait_for(true));
}

/// A program that ends in the middle of a DFU transfer, and a cable that is pulled there.
TYPED_TEST(Usb, InterruptedDfuTransferKeepsModel) {
  BoardOnUsb<TypeParam> board;
  const auto& model = BoardOnUsb<TypeParam>::blob().written().bytes;
  const auto* const bytes = reinterpret_cast<const unsigned char*>(model.data());
  const std::vector<unsigned char> first_block(bytes, bytes + 512);
  for (const bool pull : {false, true}) {
    ASSERT_TRUE(open_board());
    libusb_context* context = nullptr;
    ASSERT_EQ(libusb_init(&context), 0);
    libusb_device_handle* device = libusb_open_device_with_vid_pid(context, 0x1209, 0x0001);
    ASSERT_NE(device, nullptr);
    ASSERT_EQ(libusb_claim_interface(device, 1), 0);
    const auto request = [&](std::uint8_t type, std::uint8_t number,
                             std::vector<unsigned char> data) {
      return libusb_control_transfer(device, type, number, 0, 1, data.data(),
                                     static_cast<std::uint16_t>(data.size()), 60000);
    };
    // The next tool starts in the state left by the last one.
    EXPECT_TRUE(eventually([&] {
      std::array<unsigned char, 6> status{};
      const int length = libusb_control_transfer(device, 0xA1, 3, 0, 1, status.data(), 6, 60000);
      return length == 6 &&
             status[4] != static_cast<unsigned char>(core::usb::DfuState::kDownloadBusy);
    }));
    ASSERT_EQ(request(0x21, 6, {}), 0);
    ASSERT_EQ(request(0x21, 1, first_block), 512);
    EXPECT_TRUE(
        eventually([&] { return board.model_state() == core::usb::DfuState::kDownloadSync; }));
    if (pull) {
      board.plug(false);
    }
    libusb_release_interface(device, 1);
    libusb_close(device);
    libusb_exit(context);
    if (pull) {
      EXPECT_TRUE(eventually([&] { return board.model_state() == core::usb::DfuState::kIdle; }));
      board.plug(true);
    }
    Application application(open_board());
    ASSERT_TRUE(application.open().ok());
    const client::Response state = application.ask(MessageKind::kState);
    core::wire::StateReply reply;
    ASSERT_TRUE(state.read(reply));
    EXPECT_EQ(reply.state, static_cast<std::uint8_t>(core::State::kIdle)) << "the model is there";
  }
}

int run(const std::string& command) { return std::system((command + " >&2").c_str()); }

test::UsbBytes contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void exchange_models_by_dfu_util(const test::UsbBytes& model, int times) {
  const std::string tool = "dfu-util -d 1209:0001 -a model ";
  const std::string file = "/run/uploaded";
  for (int i = 0; i < times; ++i) {
    std::remove(file.c_str());
    ASSERT_EQ(run(tool + "-U " + file), 0);
    EXPECT_EQ(contents(file), model);
    ASSERT_EQ(run(tool + "-D " + file), 0);
  }
}

template <class Port>
test::UsbBytes model_of_board() {
  const auto& model = BoardOnUsb<Port>::blob().written().bytes;
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(model.data());
  return {bytes, bytes + model.size()};
}

TYPED_TEST(Usb, ServesDfuUtil) {
  const BoardOnUsb<TypeParam> board;
  ASSERT_TRUE(open_board());
  exchange_models_by_dfu_util(model_of_board<TypeParam>(), 2);
}

/// Prints what this kernel, libusb, lsusb and dfu-util submit: scripts/record-usb-host.
TEST(UsbRecording, DISABLED_OfLinuxHost) {
  std::ostringstream text;
  test::UsbRecording recording(text);
  {
    const BoardOnUsb<OtgPort> board(std::chrono::milliseconds(1), &recording);
    {
      Application application(open_board());
      ASSERT_TRUE(application.open().ok());
      ASSERT_TRUE(application.ask(MessageKind::kIdentify).ok());
      int messages = 0;
      application.client().on_telemetry([&](const client::Telemetry&) { ++messages; });
      ASSERT_TRUE(
          application.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 1}).ok());
      while (messages < 10) {
        application.turn();
      }
      ASSERT_TRUE(
          application.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0, 1}).ok());
      using core::wire::ControlCode;
      for (const ControlCode code : {ControlCode::kArm, ControlCode::kStop}) {
        const core::wire::ControlRequest request{static_cast<std::uint8_t>(code), {}, 0};
        ASSERT_TRUE(application.ask(MessageKind::kControl, request).ok());
        ASSERT_TRUE(eventually([&] {
          application.turn();
          return application.transport().take_news().has_value();
        }));
      }
    }
    ASSERT_EQ(run("lsusb -v -d 1209:0001"), 0);
    exchange_models_by_dfu_util(model_of_board<OtgPort>(), 1);
  }
  std::cout << "recording begins\n" << text.str() << "recording ends\n";
}

}  // namespace
}  // namespace tactree::vm_test
