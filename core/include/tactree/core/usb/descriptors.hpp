#pragma once
// What the device tells a USB host of itself. A device of three functions, each one interface:
//   0  the link: messages as in wire/frame.hpp over bulk endpoints, news over an interrupt endpoint
//   1  the model, over DFU 1.1
//   2  the parameters, over DFU 1.1
// Two DFU interfaces rather than one with alternate settings: Linux's FunctionFS has none, and
// tools tell the two apart by name all the same (`dfu-util -a model`).
// Microsoft OS 2.0 descriptors make Windows load WinUSB by itself, so no driver is needed there.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core::usb {

inline constexpr std::uint8_t kInterfaces = 3;
inline constexpr std::uint8_t kLinkInterface = 0;
inline constexpr std::uint8_t kModelInterface = 1;
inline constexpr std::uint8_t kParameterInterface = 2;

/// By these an application knows the link, whoever made the device.
inline constexpr std::uint8_t kLinkClass = 0xFF;     ///< vendor's own
inline constexpr std::uint8_t kLinkSubclass = 0x54;  ///< 'T'
inline constexpr std::uint8_t kLinkProtocol = 1;     ///< major version of the wire protocol

inline constexpr std::uint8_t kBulkOut = 0x01;
inline constexpr std::uint8_t kBulkIn = 0x81;
inline constexpr std::uint8_t kNewsIn = 0x82;  ///< interrupt: NewsPacket

inline constexpr std::uint16_t kControlPacketBytes = 64;
inline constexpr std::uint16_t kBulkPacketBytesFull = 64;
inline constexpr std::uint16_t kBulkPacketBytesHigh = 512;
inline constexpr std::uint16_t kDfuTransferBytes = 512;

/// Vendor request with which Windows fetches the Microsoft OS 2.0 descriptors.
inline constexpr std::uint8_t kMicrosoftRequest = 0x20;
inline constexpr std::uint16_t kMicrosoftDescriptorIndex = 7;

/// On the interrupt endpoint, whenever state or faults change: an application needs no polling.
struct NewsPacket {
  std::uint32_t tick = 0;
  std::uint32_t state = 0;  ///< State
  std::uint32_t faults = 0;
  std::uint32_t limits = 0;
};
static_assert(sizeof(NewsPacket) == 16);

enum class Speed : std::uint8_t { kFull = 0, kHigh };

/// Who the device is. Vendor and product number are the maker's to set; the default is the one that
/// pid.codes keeps for experiments and must not leave a lab.
struct Identity {
  std::uint16_t vendor = 0x1209;
  std::uint16_t product = 0x0001;
  std::uint16_t release = 0x0100;          ///< binary-coded decimal
  const char* maker = "Tactree";           ///< ASCII, up to 31 characters
  const char* name = "Haptic controller";  ///< ASCII, up to 31 characters
  std::array<std::uint32_t, 3> serial{};   ///< the chip's unique number
};

inline constexpr std::size_t kDeviceDescriptorBytes = 18;
inline constexpr std::size_t kQualifierBytes = 10;
inline constexpr std::size_t kConfigurationBytes = 75;
inline constexpr std::size_t kBosBytes = 33;
inline constexpr std::size_t kMicrosoftBytes = 498;
inline constexpr std::size_t kStringBytesMax = 64;

enum class StringIndex : std::uint8_t {
  kLanguages = 0,
  kMaker,
  kName,
  kSerial,
  kLink,
  kModel,
  kParameters,
};
inline constexpr std::uint8_t kStrings = 7;

[[nodiscard]] std::array<std::byte, kDeviceDescriptorBytes> device_descriptor(
    const Identity& identity);
/// For the speed that the device does not run at now.
[[nodiscard]] std::array<std::byte, kQualifierBytes> qualifier_descriptor();
/// All of the configuration; `type` is 2, or 7 for that of the other speed.
[[nodiscard]] std::array<std::byte, kConfigurationBytes> configuration_descriptor(
    Speed speed, std::uint8_t type = 2);
/// Of interfaces and endpoints only: what follows the configuration's own nine bytes.
inline constexpr std::size_t kInterfacesOffset = 9;

[[nodiscard]] std::span<const std::byte, kBosBytes> bos_descriptor();
[[nodiscard]] std::span<const std::byte, kMicrosoftBytes> microsoft_descriptors();

/// Writes string descriptor `index` to `out`; returns its length, 0: there is none.
[[nodiscard]] std::size_t string_descriptor(std::uint8_t index, const Identity& identity,
                                            std::span<std::byte, kStringBytesMax> out);
/// Zero-terminated, 24 digits.
[[nodiscard]] std::array<char, 25> serial_text(const Identity& identity);
/// Of an interface: "link", "model", "parameters".
[[nodiscard]] const char* interface_name(std::uint8_t interface);

}  // namespace tactree::core::usb
