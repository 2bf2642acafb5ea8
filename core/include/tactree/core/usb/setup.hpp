#pragma once
// What a USB host asks on endpoint 0, as numbers (USB 2.0, chapter 9), and what is answered.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core::usb {

/// The eight bytes that begin a control transfer.
struct SetupPacket {
  // NOLINTBEGIN(readability-identifier-naming): as the standard calls them
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

inline constexpr std::uint16_t kEndpointHalt = 0;  ///< a feature

/// How a control transfer goes on.
struct Answer {
  enum class Kind : std::uint8_t {
    kStall = 0,    ///< refused
    kAcknowledge,  ///< done; there is no data
    kSend,         ///< `data` goes to the host
    kReceive,      ///< the host sends wLength bytes; then the request is judged
  };
  /// What the device controller has to do, after the status stage.
  enum class Effect : std::uint8_t {
    kNone = 0,
    kTakeAddress,  ///< `value`
    kConfigure,    ///< configuration `value`; 0: none
    kHalt,         ///< endpoint with address `value`
    kClearHalt,    ///< and its data toggle
  };
  Kind kind = Kind::kStall;
  Effect effect = Effect::kNone;
  std::uint8_t value = 0;
  std::span<const std::byte> data{};  ///< holds until the next request; wLength bytes at most
};

[[nodiscard]] inline Answer stall() { return {}; }
[[nodiscard]] inline Answer acknowledge() {
  return {Answer::Kind::kAcknowledge, Answer::Effect::kNone, 0, {}};
}
[[nodiscard]] inline Answer receive() {
  return {Answer::Kind::kReceive, Answer::Effect::kNone, 0, {}};
}
/// No more than the host asked for.
[[nodiscard]] inline Answer send(std::span<const std::byte> data, const SetupPacket& setup) {
  const std::size_t size = data.size() < setup.wLength ? data.size() : setup.wLength;
  return {Answer::Kind::kSend, Answer::Effect::kNone, 0, data.first(size)};
}

}  // namespace tactree::core::usb
