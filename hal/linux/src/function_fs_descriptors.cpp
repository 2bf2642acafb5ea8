// Loop and memory annotations: docs/BOUND.md.

#include "function_fs_descriptors.hpp"

#include <linux/usb/functionfs.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "tactree/core/link/usb/descriptors.hpp"

namespace tactree::hal::linux_usb {
namespace {

using Bytes = std::vector<std::byte>;

void put(Bytes& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

template <class T>
void put_raw(Bytes& out, const T& value) {
  put(out, std::as_bytes(std::span(&value, 1)));
}

void put_u32(Bytes& out, std::uint32_t value) { put_raw(out, value); }

struct Descriptors {
  Bytes bytes;
  std::uint32_t count = 0;
};

/// Interface and endpoint descriptors of the configuration for that speed. FunctionFS numbers
/// strings from 1.
Descriptors interfaces_of(core::usb::Speed speed, bool with_dfu) {
  const auto all = core::usb::configuration_descriptor(speed);
  Descriptors found;
  std::size_t at = core::usb::kInterfacesOffset;
  while (at < all.size()) {  // bound: descriptors of the configuration
    const auto size = static_cast<std::size_t>(all[at]);
    Bytes one(all.begin() + static_cast<long>(at), all.begin() + static_cast<long>(at + size));
    if (one[1] == std::byte{4}) {  // interface descriptor
      if (!with_dfu && one[2] != std::byte{core::usb::kLinkInterface}) {
        break;
      }
      const auto first = static_cast<std::uint8_t>(core::usb::StringIndex::kLink);
      one[8] = static_cast<std::byte>(static_cast<std::uint8_t>(one[8]) - first + 1U);
    }
    put(found.bytes, one);
    ++found.count;
    at += size;
  }
  return found;
}

std::uint8_t interfaces(bool with_dfu) { return with_dfu ? core::usb::kInterfaces : 1; }

/// Microsoft OS descriptors: Windows loads WinUSB for each interface.
Bytes windows_descriptors(bool with_dfu) {
  Bytes out;
  for (std::uint8_t i = 0; i < interfaces(with_dfu); ++i) {  // bound: kInterfaces
    usb_os_desc_header header{};
    header.interface = i;
    header.dwLength = sizeof(header) + sizeof(usb_ext_compat_desc);
    header.bcdVersion = 1;
    header.wIndex = 4;
    header.bCount = 1;
    put_raw(out, header);
    usb_ext_compat_desc compatible{};
    compatible.bFirstInterfaceNumber = i;
    compatible.Reserved1 = 1;
    std::memcpy(compatible.CompatibleID, "WINUSB", 6);
    put_raw(out, compatible);
  }
  return out;
}

}  // namespace

Bytes function_fs_descriptors(bool with_dfu) {
  const Descriptors full = interfaces_of(core::usb::Speed::kFull, with_dfu);
  const Descriptors high = interfaces_of(core::usb::Speed::kHigh, with_dfu);
  const Bytes windows = windows_descriptors(with_dfu);
  Bytes out;
  put_u32(out, FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  put_u32(out, 0);  // length, set below
  put_u32(out, FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC | FUNCTIONFS_HAS_MS_OS_DESC);
  put_u32(out, full.count);
  put_u32(out, high.count);
  put_u32(out, interfaces(with_dfu));
  put(out, full.bytes);
  put(out, high.bytes);
  put(out, windows);
  const auto length = static_cast<std::uint32_t>(out.size());
  std::memcpy(out.data() + 4, &length, sizeof(length));
  return out;
}

Bytes function_fs_strings(bool with_dfu) {
  Bytes names;
  for (std::uint8_t i = 0; i < interfaces(with_dfu); ++i) {  // bound: kInterfaces
    const std::string name = core::usb::interface_name(i);
    put(names, std::as_bytes(std::span(name.c_str(), name.size() + 1)));
  }
  Bytes out;
  put_u32(out, FUNCTIONFS_STRINGS_MAGIC);
  put_u32(out, static_cast<std::uint32_t>(16 + 2 + names.size()));
  put_u32(out, interfaces(with_dfu));
  put_u32(out, 1);  // languages
  put_raw(out, std::uint16_t{0x0409});
  put(out, names);
  return out;
}

}  // namespace tactree::hal::linux_usb
