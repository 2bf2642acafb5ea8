#pragma once
// Values that depend on the wiring of the board: crystal, clocks and alternate functions of the
// peripherals, amplifiers and device. Adapt this file for another board with this chip.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::firmware::wiring {

inline constexpr std::uint32_t kCrystalMHz = 25;  ///< 4 .. 26
/// Both the bus clock at full speed (84 MHz) and the internal oscillator (16 MHz) are multiples of
/// this rate, so the rate is as accurate as the clock. At a lower rate telemetry would delay
/// replies.
inline constexpr std::uint32_t kBaud = 1000000;

// GPIO A, B, C and DMA2 in AHB1ENR, OTG FS in AHB2ENR (RM0090, sections 7.3.10 and 7.3.11).
inline constexpr std::uint32_t kAhb1Clocks = (1U << 0) | (1U << 1) | (1U << 2) | (1U << 22);
inline constexpr std::uint32_t kAhb2Clocks = 1U << 7;
inline constexpr std::uint32_t kApb1Clocks = (1U << 0) | (1U << 2) | (1U << 3);  // TIM2, 4, 5
inline constexpr std::uint32_t kApb2Clocks = (1U << 1) | (1U << 4);              // TIM8, USART1

/// Numbers of the alternate functions: data sheet, table 9.
inline constexpr std::uint32_t kTim2Function = 1;
inline constexpr std::uint32_t kTim4Function = 2;
inline constexpr std::uint32_t kTim5Function = 2;
inline constexpr std::uint32_t kTim8Function = 3;
inline constexpr std::uint32_t kUsart1Function = 7;
inline constexpr std::uint32_t kOtgFsFunction = 10;

/// Effort of an axis at a duty cycle of 1, N or Nm.
inline constexpr float kEffortAtFullWidth[core::kAxes] = {1.9F, 1.8F, 1.5F};

/// Ed25519 public key of 32 bytes whose signature a model needs; nullptr: none. With a key the
/// program is larger than its sectors: README.md.
inline constexpr const std::uint8_t* kModelKey = nullptr;

/// Set it after the first force has shown that every motor pushes the right way: README.md, "First
/// power-on". Until then the board gives at most 0.5 N, and does not carry the weight of the device
/// (core::first_force()).
inline constexpr bool kSignsProven = false;

/// What an application at the port is for.
enum class LinkUse : std::uint8_t {
  kMayOperate,  ///< the board needs none: button and dead-man control suffice. One that connects
                ///< with the motors off may operate the board, too; the force then ends with it
  kOperates,    ///< it arms, and the force ends without it; the button arms as well
  kWatches,     ///< button and dead-man control alone operate the board, the link may come and go;
                ///< an application may watch and stop
};
inline constexpr LinkUse kLinkUse = LinkUse::kMayOperate;

/// Configuration of the device. The device is homed by hand (HomingMethod::kGivenPose).
inline core::Configuration configuration(LinkUse use = kLinkUse, bool signs_proven = kSignsProven) {
  core::Configuration configuration;
  core::use_device(core::presets::premium(), configuration);
  configuration.rate_hz = 1000.0F;  // the watchdog requires at least this rate
  configuration.link.required = use == LinkUse::kOperates;
  configuration.link.may_command = use != LinkUse::kWatches;
  configuration.link.timeout_s = 0.1F;
  return signs_proven ? configuration : core::first_force(configuration);
}

}  // namespace tactree::firmware::wiring
