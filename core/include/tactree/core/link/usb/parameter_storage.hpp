#pragma once
// The parameters (parameters.hpp) as a file for DFU, little-endian:
//   u32 "TTPR", u16 version, u16 count, f32[count] in the order of their numbers, u32 CRC-32 of all
//   before it
// A file sets all parameters or none, and only while the motors are off and if the link may command
// (LinkSupervision::may_command).
//
// Interrupt safety: no shared state except the controller's; call outside the tick.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/configuration/parameters.hpp"
#include "tactree/core/control/between_ticks.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/usb/dfu.hpp"
#include "tactree/core/math/crc32.hpp"

namespace tactree::core::usb {

struct ParameterFile {
  static constexpr std::uint32_t kMagic = 0x52505454;  // "TTPR"
  static constexpr std::uint16_t kVersion = 1;
  std::uint32_t magic = kMagic;
  std::uint16_t version = kVersion;
  std::uint16_t count = kParameters;
  float values[kParameters] = {};
  std::uint32_t checksum = 0;
};
static_assert(sizeof(ParameterFile) == 8 + 4 * kParameters + 4);

[[nodiscard]] inline std::uint32_t checksum_of(const ParameterFile& file) {
  const auto bytes = std::as_bytes(std::span(&file, 1));
  return crc32(bytes.first(offsetof(ParameterFile, checksum)));
}

/// `Platform`: see BetweenTicks.
template <class Platform>
class ParameterStorage {
 public:
  ParameterStorage(Controller& controller, Platform& platform) : changes_(controller, platform) {}

  [[nodiscard]] DfuStatus begin() {
    received_ = 0;
    return may_change() ? DfuStatus::kOk : DfuStatus::kTarget;
  }

  [[nodiscard]] DfuStatus write(std::uint32_t offset, std::span<const std::byte> bytes) {
    if (offset > sizeof(file_) || bytes.size() > sizeof(file_) - offset) {
      return DfuStatus::kAddress;
    }
    __builtin_memcpy(reinterpret_cast<std::byte*>(&file_) + offset, bytes.data(), bytes.size());
    received_ = offset + bytes.size();
    return DfuStatus::kOk;
  }

  [[nodiscard]] DfuStatus finish() {
    if (received_ != sizeof(file_)) {
      return DfuStatus::kNotDone;
    }
    if (!may_change()) {
      return DfuStatus::kTarget;
    }
    if (file_.checksum != checksum_of(file_)) {
      return DfuStatus::kVerify;
    }
    Configuration configuration = changes_.controller().configuration();
    if (!is_ours() || !take_values(configuration)) {
      return DfuStatus::kFile;
    }
    const ConfigurationStatus status = changes_.configure(configuration);
    if (status == ConfigurationStatus::kBusy) {
      return DfuStatus::kTarget;
    }
    return status == ConfigurationStatus::kOk ? DfuStatus::kOk : DfuStatus::kFile;
  }

  [[nodiscard]] DfuProgress progress() const { return {}; }
  void abort() { received_ = 0; }

  [[nodiscard]] DfuStatus read(std::uint32_t offset, std::span<std::byte> bytes,
                               std::size_t& count) {
    ParameterFile now;
    for (std::uint32_t i = 0; i < kParameters; ++i) {  // bound: kParameters
      now.values[i] = parameter_of(changes_.controller().configuration(), i);
    }
    now.checksum = checksum_of(now);
    const std::size_t left = offset < sizeof(now) ? sizeof(now) - offset : 0;
    count = bytes.size() < left ? bytes.size() : left;
    __builtin_memcpy(bytes.data(), reinterpret_cast<const std::byte*>(&now) + offset, count);
    return DfuStatus::kOk;
  }

 private:
  [[nodiscard]] bool may_change() const {
    const Controller& controller = changes_.controller();
    return controller.motors_off() && controller.configuration().link.may_command;
  }

  [[nodiscard]] bool is_ours() const {
    return file_.magic == ParameterFile::kMagic && file_.version == ParameterFile::kVersion &&
           file_.count == kParameters;
  }

  [[nodiscard]] bool take_values(Configuration& configuration) const {
    for (std::uint32_t i = 0; i < kParameters; ++i) {  // bound: kParameters
      if (!set_parameter(configuration, i, file_.values[i])) {
        return false;
      }
    }
    return true;
  }

  BetweenTicks<Platform> changes_;
  ParameterFile file_{};
  std::size_t received_ = 0;
};

}  // namespace tactree::core::usb
