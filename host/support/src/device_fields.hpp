#pragma once
// The keys of a device file: meaning, range and default. Reader, writer, JSON schema and C++ header
// of a device all follow these tables.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::support {

/// Kinds and homing methods by their value in core.
inline constexpr const char* kKindNames[core::kDeviceKinds] = {"cartesian", "arm", "delta",
                                                               "five-bar", "paddle"};
inline constexpr const char* kHomingNames[core::kHomingMethods] = {"absolute", "given-pose",
                                                                   "index", "hard-stop"};

/// A key whose value is a string. All kinds of devices have it.
struct DeviceText {
  const char* key;
  const char* about;
  std::span<const char* const> choices;  ///< empty: any text
  bool required;
  const char* fallback;     ///< value of an optional key that is missing; nullptr: none
  const char* consequence;  ///< of the fallback; nullptr: not worth a message
};

/// Values of a field; with one value, only the first pointer is not null.
using DeviceValues = std::array<float*, core::kAxes>;

enum class DeviceShape : std::uint8_t {
  kOne,     ///< a number
  kAxes,    ///< an array in C++
  kVector,  ///< a core::Vec3 in C++
};

/// A key whose value is a number, or a list of one number for each axis. A key has several fields
/// if its range depends on the kind of the device.
struct DeviceField {
  const char* key;
  std::uint32_t kinds;  ///< bit n: core::DeviceKind n has the key
  const char* member;   ///< of core::DevicePreset, in C++
  DeviceValues (*values)(core::DevicePreset& device);
  DeviceShape shape;
  float low;
  float high;
  float magnitude_min;            ///< minimum absolute value for axes in use
  const char* about;              ///< with the unit
  std::optional<float> fallback;  ///< of every value if the key is missing; none: required
  const char* consequence;        ///< of the fallback

  [[nodiscard]] bool belongs_to(core::DeviceKind kind) const {
    return (kinds >> static_cast<std::uint32_t>(kind) & 1U) != 0U;
  }
  [[nodiscard]] bool belongs_to_all() const { return kinds == (1U << core::kDeviceKinds) - 1U; }
  [[nodiscard]] bool per_axis() const { return shape != DeviceShape::kOne; }
  [[nodiscard]] std::uint32_t count() const { return per_axis() ? core::kAxes : 1U; }
};

[[nodiscard]] std::span<const DeviceText> device_texts();
[[nodiscard]] std::span<const DeviceField> device_fields();

}  // namespace tactree::support
