#pragma once
// A served board on USB with the link, model and parameter interfaces of a real board.

#include <chrono>

#include "tactree/core/link/usb/parameter_storage.hpp"
#include "tactree/hal/usb_device.hpp"
#include "tactree/serve/served_target.hpp"
#include "tactree/session/dfu_model.hpp"

namespace tactree::serve {

/// `Controller` is a UsbController (hal/usb_device.hpp). It belongs to the caller and must outlive
/// the target.
template <hal::UsbController Controller>
class UsbTarget : public ServedTarget {
 public:
  using Model = session::DfuModel<ServedSimBoard::Store, ServedPlatform>;
  using Parameters = core::usb::ParameterStorage<ServedPlatform>;
  using Device = hal::UsbDevice<Controller, Model, Parameters>;

  UsbTarget(Controller& usb, const core::usb::Identity& identity, std::span<const std::byte> model,
            const ServeOptions& options, bool has_high_speed = true)
      : ServedTarget(port_, model, options),
        model_(store(), controller(), mailbox(), platform()),
        parameters_(controller(), platform()),
        device_(usb, identity, has_high_speed, model_, parameters_),
        port_(device_) {}

  core::Status tick(hal::sim::SimBoard& board) override {
    status_ = ServedTarget::tick(board);
    serve();
    return status_;
  }

  /// Handles requests of the host. May also be called between ticks.
  void serve() {
    // Uses real time because the simulation may be slower than the clock of the host.
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
    device_.poll(static_cast<std::uint32_t>(now_us));
    work();
    device_.send_changes(status_);
  }

  [[nodiscard]] const Device& device() const { return device_; }

 private:
  class Port : public client::Transport {
   public:
    explicit Port(Device& device) : device_(device) {}
    [[nodiscard]] std::size_t read(std::span<std::byte> bytes) override {
      return device_.read(bytes);
    }
    [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) override {
      return device_.write(bytes);
    }
    void wait(std::chrono::microseconds) override {}
    [[nodiscard]] bool connected() const override { return device_.configured(); }
    [[nodiscard]] std::string name() const override { return "usb device"; }

   private:
    Device& device_;
  };

  Model model_;
  Parameters parameters_;
  Device device_;
  Port port_;
  core::Status status_{};
};

}  // namespace tactree::serve
