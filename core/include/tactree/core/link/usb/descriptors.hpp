#pragma once
// USB descriptors of a board. There are three functions of one interface each:
//   0  the link: frames (wire/frame.hpp) over bulk endpoints, notices over an interrupt endpoint
//   1  the model, over DFU 1.1
//   2  the parameters, over DFU 1.1
// Two DFU interfaces replace the usual alternate settings, which Linux's FunctionFS does not
// support. `dfu-util -a model` selects an interface by its name.
// Microsoft OS 2.0 descriptors make Windows load WinUSB; no driver installation is required.
//
// Interrupt safety: pure functions. Constant cost, except string_descriptor(): its length.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core::usb {

inline constexpr std::uint8_t kInterfaces = 3;
inline constexpr std::uint8_t kLinkInterface = 0;
inline constexpr std::uint8_t kModelInterface = 1;
inline constexpr std::uint8_t kParameterInterface = 2;

/// Class codes that identify the link for any vendor and product number.
inline constexpr std::uint8_t kLinkClass = 0xFF;     ///< vendor specific
inline constexpr std::uint8_t kLinkSubclass = 0x54;  ///< 'T'
inline constexpr std::uint8_t kLinkProtocol = 1;     ///< major version of the wire protocol

inline constexpr std::uint8_t kBulkOut = 0x01;
inline constexpr std::uint8_t kBulkIn = 0x81;
inline constexpr std::uint8_t kNewsIn = 0x82;  ///< interrupt: NewsPacket

/// Maximum packet sizes of USB 2.0, sections 5.5.3 and 5.8.3.
inline constexpr std::uint16_t kControlPacketBytes = 64;
inline constexpr std::uint16_t kBulkPacketBytesFull = 64;
inline constexpr std::uint16_t kBulkPacketBytesHigh = 512;
/// Bytes of a DFU block: two pieces of a model (wire::kMaxPiece). Each DFU function holds a block
/// in RAM, and that of the model a second one: 1.5 KiB. In a download each block takes at least two
/// control transfers, data and status, so that smaller blocks would be slower.
inline constexpr std::uint16_t kDfuTransferBytes = 512;

/// Vendor request by which Windows reads the Microsoft OS 2.0 descriptors.
inline constexpr std::uint8_t kMicrosoftRequest = 0x20;
inline constexpr std::uint16_t kMicrosoftDescriptorIndex = 7;

/// Sent on the interrupt endpoint whenever state or faults change.
struct NewsPacket {
  std::uint32_t tick = 0;
  std::uint32_t state = 0;  ///< State
  std::uint32_t faults = 0;
  std::uint32_t limits = 0;
};
static_assert(sizeof(NewsPacket) == 16);

enum class Speed : std::uint8_t { kFull = 0, kHigh };

/// Identity of the device. The manufacturer sets vendor and product number. The default is the test
/// number of pid.codes, which must not be used outside a laboratory.
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
/// Describes the speed that is not in use.
[[nodiscard]] std::array<std::byte, kQualifierBytes> qualifier_descriptor();
/// The whole configuration; `type` is 2, or 7 for the speed that is not in use.
[[nodiscard]] std::array<std::byte, kConfigurationBytes> configuration_descriptor(
    Speed speed, std::uint8_t type = 2);
/// Offset of the interface and endpoint descriptors in the configuration.
inline constexpr std::size_t kInterfacesOffset = 9;

[[nodiscard]] std::span<const std::byte, kBosBytes> bos_descriptor();
[[nodiscard]] std::span<const std::byte, kMicrosoftBytes> microsoft_descriptors();

/// Writes string descriptor `index` to `out`. Returns its length, or 0 if there is no such string.
[[nodiscard]] std::size_t string_descriptor(std::uint8_t index, const Identity& identity,
                                            std::span<std::byte, kStringBytesMax> out);
/// The serial number: 24 hexadecimal digits, zero-terminated.
[[nodiscard]] std::array<char, 25> serial_text(const Identity& identity);
/// Name of an interface: "link", "model", "parameters".
[[nodiscard]] const char* interface_name(std::uint8_t interface);

}  // namespace tactree::core::usb
