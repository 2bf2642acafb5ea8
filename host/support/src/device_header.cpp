// Devices as C++ headers.

#include <fmt/format.h>

#include <iterator>

#include "device_fields.hpp"
#include "tactree/support/device_file.hpp"

namespace tactree::support {
namespace {

constexpr const char* kKindLiterals[core::kDeviceKinds] = {"kCartesian", "kArm", "kDelta",
                                                           "kFiveBar", "kPaddle"};
constexpr const char* kHomingLiterals[core::kHomingMethods] = {"kAbsolute", "kGivenPose", "kIndex",
                                                               "kHardStop"};
constexpr const char* kComponents[core::kAxes] = {".x", ".y", ".z"};

/// The shortest decimal that is the same float.
std::string float_literal(float value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) {
    text += ".0";
  }
  return text + "F";
}

/// Octal escapes, because they end after three digits.
std::string string_literal(const std::string& text) {
  std::string literal = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20U || byte > 0x7EU || c == '"' || c == '\\' || c == '?') {
      fmt::format_to(std::back_inserter(literal), "\\{:03o}", byte);
    } else {
      literal += c;
    }
  }
  return literal + "\"";
}

/// Without characters that could end a comment or continue it in the next line.
std::string comment_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20U || byte > 0x7EU || c == '\\' || c == '?' ? '_' : c;
  }
  return result;
}

/// "model.ratio[1]"
std::string element(const DeviceField& field, std::size_t index) {
  switch (field.shape) {
    case DeviceShape::kOne:
      return field.member;
    case DeviceShape::kAxes:
      return fmt::format("{}[{}]", field.member, index);
    case DeviceShape::kVector:
      return std::string(field.member) + kComponents[index];
  }
  return field.member;
}

}  // namespace

std::string device_header(const Device& device, const std::string& variable,
                          const std::string& source) {
  core::DevicePreset preset = device.preset;
  std::string text = fmt::format(
      "#pragma once\n"
      "// A haptic device for the controller: tactree::core::use_device({0}, configuration).\n"
      "// Written by `tactree device to-header` from {1}. Change that file, not this one.\n\n"
      "#include \"tactree/core/configuration/device_presets.hpp\"\n\n"
      "inline constexpr tactree::core::DevicePreset {0} = [] {{\n"
      "  tactree::core::DevicePreset device;\n"
      "  device.name = {2};\n"
      "  device.about = {3};\n"
      "  device.model.kind = tactree::core::DeviceKind::{4};\n"
      "  device.model.homing = tactree::core::HomingMethod::{5};\n",
      variable, comment_text(source), string_literal(device.name), string_literal(device.about),
      kKindLiterals[static_cast<std::size_t>(preset.model.kind)],
      kHomingLiterals[static_cast<std::size_t>(preset.model.homing)]);
  for (const DeviceField& field : device_fields()) {
    if (!field.belongs_to(preset.model.kind)) {
      continue;
    }
    const DeviceValues values = field.values(preset);
    fmt::format_to(std::back_inserter(text), "  // {}\n", field.about);
    for (std::size_t i = 0; i < field.count(); ++i) {
      fmt::format_to(std::back_inserter(text), "  device.{} = {};\n", element(field, i),
                     float_literal(*values[i]));
    }
  }
  return text + "  return device;\n}();\n";
}

}  // namespace tactree::support
