// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/link/usb/descriptors.hpp"

namespace tactree::core::usb {
namespace {

/// Builds descriptors at compile time; numbers are little-endian.
template <std::size_t kSize>
class Writer {
 public:
  constexpr Writer& u8(std::uint32_t value) {
    bytes_[used_++] = static_cast<std::byte>(value & 0xFFU);
    return *this;
  }
  constexpr Writer& u16(std::uint32_t value) { return u8(value).u8(value >> 8U); }
  constexpr Writer& u32(std::uint32_t value) { return u16(value).u16(value >> 16U); }
  template <std::size_t kCount>
  constexpr Writer& raw(const std::uint8_t (&values)[kCount]) {
    for (const std::uint8_t value : values) {  // bound: kCount
      u8(value);
    }
    return *this;
  }
  /// UTF-16 text, followed by `zeros` zero characters.
  template <std::size_t kCount>
  constexpr Writer& utf16(const char (&text)[kCount], std::uint32_t zeros) {
    for (std::size_t i = 0; i + 1 < kCount; ++i) {  // bound: kCount
      u16(static_cast<std::uint8_t>(text[i]));
    }
    for (std::uint32_t i = 0; i < zeros; ++i) {  // bound: zeros (2 or fewer)
      u16(0);
    }
    return *this;
  }
  [[nodiscard]] constexpr std::array<std::byte, kSize> done() const { return bytes_; }
  [[nodiscard]] constexpr bool is_full() const { return used_ == kSize; }

 private:
  std::array<std::byte, kSize> bytes_{};
  std::size_t used_ = 0;
};

constexpr std::uint32_t kVersion201 = 0x0201;  // the first version with a BOS
constexpr std::uint32_t kDfuClass = 0xFE;      // application specific
constexpr std::uint32_t kDfuSubclass = 1;
constexpr std::uint32_t kDfuMode = 2;
// Can download and upload; manifestation tolerant.
constexpr std::uint32_t kDfuAttributes = 0x07;
constexpr std::uint32_t kDfuDetachTimeoutMs = 1000;  // no effect: it never leaves DFU mode
constexpr std::uint32_t kDfuVersion = 0x0110;
constexpr std::uint32_t kSelfPowered = 0xC0;    // the bus does not power the motors
constexpr std::uint32_t kCurrentMax = 50;       // unit: 2 mA; 100 mA: any port of a hub has them
constexpr std::uint32_t kNewsIntervalFull = 1;  // ms
constexpr std::uint32_t kNewsIntervalHigh = 4;  // 2^(4-1) microframes: 1 ms

template <std::size_t kSize>
constexpr void add_interface(Writer<kSize>& writer, std::uint32_t number, std::uint32_t endpoints,
                             std::uint32_t type, std::uint32_t subclass, std::uint32_t protocol,
                             StringIndex name) {
  writer.u8(9).u8(4).u8(number).u8(0).u8(endpoints);
  writer.u8(type).u8(subclass).u8(protocol).u8(static_cast<std::uint8_t>(name));
}

template <std::size_t kSize>
constexpr void add_endpoint(Writer<kSize>& writer, std::uint32_t address, std::uint32_t attributes,
                            std::uint32_t packet_bytes, std::uint32_t interval) {
  writer.u8(7).u8(5).u8(address).u8(attributes).u16(packet_bytes).u8(interval);
}

template <std::size_t kSize>
constexpr void add_dfu(Writer<kSize>& writer, std::uint32_t number, StringIndex name) {
  add_interface(writer, number, 0, kDfuClass, kDfuSubclass, kDfuMode, name);
  writer.u8(9).u8(0x21).u8(kDfuAttributes).u16(kDfuDetachTimeoutMs);
  writer.u16(kDfuTransferBytes).u16(kDfuVersion);
}

constexpr Writer<kConfigurationBytes> write_configuration(Speed speed) {
  const bool high = speed == Speed::kHigh;
  const std::uint32_t packet = high ? kBulkPacketBytesHigh : kBulkPacketBytesFull;
  Writer<kConfigurationBytes> writer;
  writer.u8(9).u8(2).u16(kConfigurationBytes).u8(kInterfaces).u8(1).u8(0);
  writer.u8(kSelfPowered).u8(kCurrentMax);
  add_interface(writer, kLinkInterface, 3, kLinkClass, kLinkSubclass, kLinkProtocol,
                StringIndex::kLink);
  add_endpoint(writer, kBulkOut, 2, packet, 0);
  add_endpoint(writer, kBulkIn, 2, packet, 0);
  add_endpoint(writer, kNewsIn, 3, sizeof(NewsPacket),
               high ? kNewsIntervalHigh : kNewsIntervalFull);
  add_dfu(writer, kModelInterface, StringIndex::kModel);
  add_dfu(writer, kParameterInterface, StringIndex::kParameters);
  return writer;
}
static_assert(write_configuration(Speed::kFull).is_full());
// Smaller than the code that writes them.
constexpr auto kFullConfiguration = write_configuration(Speed::kFull).done();
constexpr auto kHighConfiguration = write_configuration(Speed::kHigh).done();

constexpr std::uint32_t kWindows81 = 0x06030000;  // the first version that reads these descriptors

constexpr Writer<kBosBytes> write_bos() {
  // UUID of the Microsoft OS 2.0 platform capability: D8DD60DF-4589-4CC7-9CD2-659D9E648A9F.
  constexpr std::uint8_t kPlatform[16] = {0xDF, 0x60, 0xDD, 0xD8, 0x89, 0x45, 0xC7, 0x4C,
                                          0x9C, 0xD2, 0x65, 0x9D, 0x9E, 0x64, 0x8A, 0x9F};
  Writer<kBosBytes> writer;
  writer.u8(5).u8(15).u16(kBosBytes).u8(1);
  writer.u8(28).u8(16).u8(5).u8(0).raw(kPlatform);
  writer.u32(kWindows81).u16(kMicrosoftBytes).u8(kMicrosoftRequest).u8(0);
  return writer;
}
static_assert(write_bos().is_full());

constexpr std::uint32_t kFunctionSubsetBytes = 160;  // as add_windows_function() writes
constexpr char kPropertyName[] = "DeviceInterfaceGUIDs";
constexpr char kLinkGuid[] = "{6A9C0E4B-3D57-4F0C-9F3E-7B1D5E2C8A41}";
constexpr char kDfuGuid[] = "{B2F0D6C8-51E7-4E0B-8D2A-0C9E4F7A1365}";

template <std::size_t kSize>
constexpr void add_windows_function(Writer<kSize>& writer, std::uint32_t interface,
                                    const char (&guid)[39]) {
  constexpr std::uint8_t kWinUsb[16] = {'W', 'I', 'N', 'U', 'S', 'B'};
  constexpr std::uint32_t kNameBytes = 2 * sizeof(kPropertyName);
  constexpr std::uint32_t kGuidBytes = 2 * (sizeof(guid) + 1);  // a list: ends with two zeros
  writer.u16(8).u16(2).u8(interface).u8(0).u16(kFunctionSubsetBytes);
  writer.u16(20).u16(3).raw(kWinUsb);
  writer.u16(10 + kNameBytes + kGuidBytes).u16(4).u16(7);
  writer.u16(kNameBytes).utf16(kPropertyName, 1).u16(kGuidBytes).utf16(guid, 2);
}

constexpr Writer<kMicrosoftBytes> write_microsoft() {
  Writer<kMicrosoftBytes> writer;
  writer.u16(10).u16(0).u32(kWindows81).u16(kMicrosoftBytes);
  writer.u16(8).u16(1).u8(0).u8(0).u16(kMicrosoftBytes - 10);
  add_windows_function(writer, kLinkInterface, kLinkGuid);
  add_windows_function(writer, kModelInterface, kDfuGuid);
  add_windows_function(writer, kParameterInterface, kDfuGuid);
  return writer;
}
static_assert(write_microsoft().is_full());

constexpr std::array<std::byte, kBosBytes> kBos = write_bos().done();
constexpr std::array<std::byte, kMicrosoftBytes> kMicrosoft = write_microsoft().done();

std::size_t write_string(const char* text, std::span<std::byte, kStringBytesMax> out) {
  std::size_t size = 2;
  for (; *text != '\0' && size + 2 <= out.size(); ++text) {  // bound: kStringBytesMax / 2
    out[size++] = static_cast<std::byte>(*text);
    out[size++] = std::byte{0};
  }
  out[0] = static_cast<std::byte>(size);
  out[1] = std::byte{3};
  return size;
}

std::size_t write_languages(std::span<std::byte, kStringBytesMax> out) {
  out[0] = std::byte{4};
  out[1] = std::byte{3};
  out[2] = std::byte{0x09};  // English (United States): 0x0409
  out[3] = std::byte{0x04};
  return 4;
}

}  // namespace

std::array<std::byte, kDeviceDescriptorBytes> device_descriptor(const Identity& identity) {
  Writer<kDeviceDescriptorBytes> writer;
  writer.u8(18).u8(1).u16(kVersion201).u8(0).u8(0).u8(0).u8(kControlPacketBytes);
  writer.u16(identity.vendor).u16(identity.product).u16(identity.release);
  writer.u8(static_cast<std::uint8_t>(StringIndex::kMaker));
  writer.u8(static_cast<std::uint8_t>(StringIndex::kName));
  writer.u8(static_cast<std::uint8_t>(StringIndex::kSerial)).u8(1);
  return writer.done();
}

std::array<std::byte, kQualifierBytes> qualifier_descriptor() {
  Writer<kQualifierBytes> writer;
  writer.u8(10).u8(6).u16(kVersion201).u8(0).u8(0).u8(0).u8(kControlPacketBytes).u8(1).u8(0);
  return writer.done();
}

std::array<std::byte, kConfigurationBytes> configuration_descriptor(Speed speed,
                                                                    std::uint8_t type) {
  auto bytes = speed == Speed::kHigh ? kHighConfiguration : kFullConfiguration;
  bytes[1] = std::byte{type};
  return bytes;
}

std::span<const std::byte, kBosBytes> bos_descriptor() { return kBos; }

std::span<const std::byte, kMicrosoftBytes> microsoft_descriptors() { return kMicrosoft; }

const char* interface_name(std::uint8_t interface) {
  if (interface == kLinkInterface) {
    return "link";
  }
  return interface == kModelInterface ? "model" : "parameters";
}

std::array<char, 25> serial_text(const Identity& identity) {
  std::array<char, 25> text{};
  for (std::size_t digit = 0; digit < 24; ++digit) {  // bound: 24
    const std::uint32_t word = identity.serial[digit / 8];
    text[digit] = "0123456789ABCDEF"[(word >> (28U - 4U * (digit % 8))) & 0xFU];
  }
  return text;
}

std::size_t string_descriptor(std::uint8_t index, const Identity& identity,
                              std::span<std::byte, kStringBytesMax> out) {
  if (index >= kStrings) {
    return 0;
  }
  const auto string = static_cast<StringIndex>(index);
  if (string == StringIndex::kLanguages) {
    return write_languages(out);
  }
  if (string == StringIndex::kMaker || string == StringIndex::kName) {
    return write_string(string == StringIndex::kMaker ? identity.maker : identity.name, out);
  }
  if (string == StringIndex::kSerial) {
    return write_string(serial_text(identity).data(), out);
  }
  constexpr auto kFirst = static_cast<std::uint8_t>(StringIndex::kLink);
  return write_string(interface_name(static_cast<std::uint8_t>(index - kFirst)), out);
}

}  // namespace tactree::core::usb
