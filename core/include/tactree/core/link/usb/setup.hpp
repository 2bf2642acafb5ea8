#pragma once
// Control transfers of endpoint 0 (USB 2.0, chapter 9): requests and responses.
//
// Interrupt safety: plain data and pure functions.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core::usb {

/// The first eight bytes of a control transfer.
struct SetupPacket {
  // NOLINTBEGIN(readability-identifier-naming): names of the standard
  std::uint8_t bmRequestType = 0;
  std::uint8_t bRequest = 0;
  std::uint16_t wValue = 0;
  std::uint16_t wIndex = 0;
  std::uint16_t wLength = 0;
  // NOLINTEND(readability-identifier-naming)

  [[nodiscard]] bool to_host() const { return (bmRequestType & 0x80U) != 0U; }
  [[nodiscard]] std::uint32_t type() const { return (bmRequestType >> 5U) & 3U; }
  [[nodiscard]] std::uint32_t recipient() const { return bmRequestType & 0x1FU; }
};
static_assert(sizeof(SetupPacket) == 8);

inline constexpr std::uint32_t kTypeStandard = 0;
inline constexpr std::uint32_t kTypeClass = 1;
inline constexpr std::uint32_t kTypeVendor = 2;
inline constexpr std::uint32_t kToDevice = 0;
inline constexpr std::uint32_t kToInterface = 1;
inline constexpr std::uint32_t kToEndpoint = 2;

inline constexpr std::uint8_t kGetStatus = 0;
inline constexpr std::uint8_t kClearFeature = 1;
inline constexpr std::uint8_t kSetFeature = 3;
inline constexpr std::uint8_t kSetAddress = 5;
inline constexpr std::uint8_t kGetDescriptor = 6;
inline constexpr std::uint8_t kGetConfiguration = 8;
inline constexpr std::uint8_t kSetConfiguration = 9;
inline constexpr std::uint8_t kGetInterface = 10;
inline constexpr std::uint8_t kSetInterface = 11;

inline constexpr std::uint16_t kEndpointHalt = 0;  ///< feature selector

/// Continuation of a control transfer.
struct ControlResponse {
  enum class Kind : std::uint8_t {
    kStall = 0,    ///< refused
    kAcknowledge,  ///< done, without data
    kSend,         ///< send `data` to the host
    kReceive,      ///< receive wLength bytes, which decide the result
  };
  /// Action of the device controller, before the status stage.
  enum class Effect : std::uint8_t {
    kNone = 0,
    kTakeAddress,  ///< use address `value` after the status stage (USB 2.0, 9.4.6)
    kConfigure,    ///< use configuration `value`; 0: none
    kHalt,         ///< halt the endpoint with address `value`
    kClearHalt,    ///< clear the halt and the data toggle of endpoint `value`
  };
  Kind kind = Kind::kStall;
  Effect effect = Effect::kNone;
  std::uint8_t value = 0;
  std::span<const std::byte> data{};  ///< valid until the next request; at most wLength bytes
};

[[nodiscard]] inline ControlResponse stall() { return {}; }
[[nodiscard]] inline ControlResponse acknowledge() {
  return {ControlResponse::Kind::kAcknowledge, ControlResponse::Effect::kNone, 0, {}};
}
[[nodiscard]] inline ControlResponse receive() {
  return {ControlResponse::Kind::kReceive, ControlResponse::Effect::kNone, 0, {}};
}
/// Sends at most the requested number of bytes.
[[nodiscard]] inline ControlResponse send(std::span<const std::byte> data,
                                          const SetupPacket& setup) {
  const std::size_t size = data.size() < setup.wLength ? data.size() : setup.wLength;
  return {ControlResponse::Kind::kSend, ControlResponse::Effect::kNone, 0, data.first(size)};
}

}  // namespace tactree::core::usb
