#pragma once
// A simulated board on USB: link, model and parameters, as the firmware's device has them.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "tactree/core/controller.hpp"
#include "tactree/core/usb/dfu.hpp"
#include "tactree/core/usb/parameter_storage.hpp"
#include "tactree/hal/linux/usbip_controller.hpp"
#include "tactree/hal/store/no_model_store.hpp"
#include "tactree/hal/usb_device.hpp"
#include "tactree/served/served_target.hpp"

namespace tactree::served {

/// The model in memory, as DFU writes and reads it: used as soon as it is whole and accepted.
class ModelInMemory {
 public:
  /// `model`: what the controller begins with.
  ModelInMemory(core::Controller& controller, std::span<const std::byte> model);

  [[nodiscard]] core::usb::DfuStatus begin();
  [[nodiscard]] core::usb::DfuStatus write(std::uint32_t offset, std::span<const std::byte> bytes);
  [[nodiscard]] core::usb::DfuStatus finish();
  [[nodiscard]] core::usb::DfuProgress progress() const { return {}; }
  void abort() { coming_.clear(); }
  [[nodiscard]] core::usb::DfuStatus read(std::uint32_t offset, std::span<std::byte> bytes,
                                          std::size_t& count);

 private:
  core::Controller& controller_;
  std::span<const std::byte> model_;
  std::size_t size_ = 0;
  std::vector<std::uint32_t> coming_;  // words: a blob is 4-byte aligned
  std::vector<std::uint32_t> in_use_;
};

class UsbBoard {
 public:
  using Parameters = core::usb::ParameterStorage<ServedPlatform>;
  using Device = hal::UsbDevice<hal::linux_usb::UsbIpController, ModelInMemory, Parameters>;
  using Target = ServedTarget<Device, hal::NoModelStore>;

  UsbBoard(const core::usb::Identity& usb, const hal::BoardIdentity& identity,
           std::span<const std::byte> model);

  /// To be given to a Simulation; this object outlives it.
  [[nodiscard]] std::unique_ptr<simulation::Target> target();
  /// Answers the host; at any time between two ticks. `status`: of the last one.
  void serve(const core::Status& status);

  [[nodiscard]] hal::linux_usb::UsbIpController& controller() { return controller_; }
  [[nodiscard]] Device& device() { return device_; }

 private:
  void tell(const core::Status& status);

  core::Controller core_;
  ServedPlatform platform_;
  hal::linux_usb::UsbIpController controller_;
  ModelInMemory model_;
  Parameters parameters_{core_, platform_};
  Device device_;
  hal::NoModelStore store_;
  hal::BoardIdentity identity_;
  Target* target_ = nullptr;
  core::usb::NewsPacket told_{};
};

}  // namespace tactree::served
