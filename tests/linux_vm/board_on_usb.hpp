#pragma once
// A simulated board on a USB port of this kernel, run by a thread; and an application's end.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "await_response.hpp"
#include "stm32f4/usb_otg_fs.hpp"
#include "tactree/client/client.hpp"
#include "tactree/client/usb_transport.hpp"
#include "tactree/hal/linux/usbip_controller.hpp"
#include "tactree/serve/usb_target.hpp"
#include "tactree/simulation/simulation.hpp"
#include "test_models.hpp"
#include "vhci_host.hpp"

namespace tactree::vm_test {

using Clock = std::chrono::steady_clock;
inline constexpr std::chrono::seconds kPatience{120};  // machines that build may stand still

/// False: timeout.
template <class Condition>
[[nodiscard]] bool eventually(Condition condition) {
  const Clock::time_point end = Clock::now() + kPatience;
  while (!condition()) {
    if (Clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// A high-speed device by USB/IP.
class UsbIpPort {
 public:
  static constexpr bool kHighSpeed = true;
  using Controller = hal::linux_usb::UsbIpController;

  [[nodiscard]] Controller& controller() { return usb_; }
  void plug_in() { usb_.plug_in(); }
  void unplug() { usb_.unplug(); }
  [[nodiscard]] bool plugged_in() const { return usb_.plugged_in(); }
  void turn() {}

 private:
  Controller usb_;
};

/// The driver of the OTG FS core of a chip, on a model of the core: what the kernel submits becomes
/// transactions on its bus.
class OtgPort {
 public:
  static constexpr bool kHighSpeed = false;
  using Controller = firmware::stm32f4::UsbOtgFs<test::FakeWord>;

  OtgPort() { EXPECT_TRUE(driver_.start()); }
  ~OtgPort() { EXPECT_EQ(core_.violation, ""); }

  [[nodiscard]] Controller& controller() { return driver_; }
  void plug_in() {
    core_.suspend(false);
    kernel_.plug_in();
  }
  void unplug() {
    kernel_.unplug();
    core_.suspend(true);  // without a host the bus is idle
  }
  [[nodiscard]] bool plugged_in() const { return kernel_.plugged_in(); }
  void turn() { kernel_.turn(kTokens); }
  void record(test::UsbRecording& recording) { kernel_.recording = &recording; }

 private:
  static constexpr int kTokens = 19;  // packets of 64 bytes in a frame (USB 2.0, table 5-9)
  test::FakeUsbOtg core_;
  test::UsbHost host_{core_};
  Controller driver_{core_.block};
  VhciHost kernel_{host_};
};

template <class Port>
class BoardOnUsb {
 public:
  /// period: of a tick; 0: as fast as it goes.
  explicit BoardOnUsb(std::chrono::microseconds period = std::chrono::milliseconds(1),
                      test::UsbRecording* recording = nullptr)
      : period_(period), recording_(recording), thread_([this] { run(); }) {}
  ~BoardOnUsb() {
    end_ = true;
    thread_.join();
  }

  /// Done when the board has noticed.
  void plug(bool in) {
    wanted_ = in;
    ASSERT_TRUE(eventually([&] { return plugged_ == in; }));
  }
  [[nodiscard]] static const test::TestBlob& blob() {
    static const test::TestBlob kBlob(test::sphere(0.03, 4e-3));
    return kBlob;
  }
  [[nodiscard]] core::usb::DfuState model_state() const { return model_state_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }

 private:
  using Target = serve::UsbTarget<typename Port::Controller>;

  static simulation::Setup setup() {
    simulation::Setup setup;
    setup.controller.supervision.dead_man_required = false;
    return setup;
  }

  void run() {
    const std::span<const std::byte> bytes = blob().written().bytes;
    core::usb::Identity identity;
    identity.serial = {0x11111111, 0x22222222, 0x33333333};
    serve::ServeOptions options;
    options.slot_bytes = 1U << 20U;
    const auto port = std::make_unique<Port>();
    if constexpr (!Port::kHighSpeed) {
      if (recording_ != nullptr) {
        port->record(*recording_);
      }
    }
    auto owned =
        std::make_unique<Target>(port->controller(), identity, bytes, options, Port::kHighSpeed);
    Target& target = *owned;
    simulation::Simulation sim(bytes, setup(), simulation::HandPath({{0.0, {0.05, 0.0, 0.0}}}),
                               std::move(owned));
    Clock::time_point next = Clock::now();
    while (!end_) {
      (void)sim.step();
      ++ticks_;
      next = std::max(next + period_, Clock::now());
      do {
        move_cable(*port);
        target.serve();
        port->turn();
        model_state_ = target.device().model().state();
        if (period_.count() > 0) {
          std::this_thread::sleep_for(std::chrono::microseconds(50));
        }
      } while (Clock::now() < next && !end_);
    }
    port->unplug();
  }

  void move_cable(Port& port) {
    if (wanted_ != port.plugged_in()) {
      if (wanted_) {
        port.plug_in();
      } else {
        port.unplug();
      }
    }
    plugged_ = port.plugged_in();
  }

  std::chrono::microseconds period_;
  test::UsbRecording* recording_;
  std::atomic<bool> end_ = false;
  std::atomic<bool> wanted_ = true;
  std::atomic<bool> plugged_ = false;
  std::atomic<std::uint64_t> ticks_ = 0;
  std::atomic<core::usb::DfuState> model_state_ = core::usb::DfuState::kIdle;
  std::thread thread_;
};

/// A client over a transport; waiting functions advance it.
class Application {
 public:
  explicit Application(std::unique_ptr<client::UsbTransport> transport)
      : transport_(std::move(transport)) {}

  [[nodiscard]] static client::Microseconds now_us() {
    return static_cast<client::Microseconds>(
        std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
            .count());
  }

  void turn(std::chrono::microseconds wait = std::chrono::milliseconds(1)) {
    std::array<std::byte, 4096> bytes{};
    client_.advance(now_us());
    const std::size_t sent = transport_->write(client_.to_send());
    client_.sent(sent);
    transport_->wait(wait);
    const std::size_t count = transport_->read(bytes);
    received_ += count;
    client_.receive(std::span(bytes).first(count), now_us());
  }

  client::Response await(std::uint16_t sequence) {
    const Clock::time_point end = Clock::now() + kPatience;
    return test::await_response(
        client_, sequence, [&] { return Clock::now() < end && transport_->connected(); },
        [&] { turn(); });
  }
  template <core::wire::Message T>
  client::Response ask(core::wire::MessageKind kind, const T& message) {
    return await(client_.send(kind, message, now_us()));
  }
  client::Response ask(core::wire::MessageKind kind) {
    return await(client_.send(kind, std::span<const std::byte>(), now_us()));
  }
  /// Acts as a new program: the board distinguishes programs by this number.
  client::Response open() {
    static std::uint32_t programs = 0;
    return await(client_.open(0, ++programs, now_us()));
  }

  [[nodiscard]] client::Client& client() { return client_; }
  [[nodiscard]] client::UsbTransport& transport() { return *transport_; }
  [[nodiscard]] std::uint64_t received() const { return received_; }

 private:
  std::unique_ptr<client::UsbTransport> transport_;
  client::Client client_{{static_cast<client::Microseconds>(60'000'000), 60'000'000}};
  std::uint64_t received_ = 0;
};

/// Waits until the board is connected, and opens it.
[[nodiscard]] inline std::unique_ptr<client::UsbTransport> open_board() {
  std::unique_ptr<client::UsbTransport> transport;
  std::string why;
  const bool there = eventually([&] {
    try {
      transport = client::open_usb("");
    } catch (const std::runtime_error& error) {
      why = error.what();
    }
    return transport != nullptr;
  });
  EXPECT_TRUE(there) << why;
  return transport;
}

}  // namespace tactree::vm_test
