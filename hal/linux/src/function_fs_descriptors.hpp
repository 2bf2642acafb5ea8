#pragma once
// Descriptors of the device in the format of FunctionFS.

#include <cstddef>
#include <vector>

namespace tactree::hal::linux_usb {

/// Descriptors of both speeds, with or without the DFU interfaces.
[[nodiscard]] std::vector<std::byte> function_fs_descriptors(bool with_dfu);
/// Names of the interfaces.
[[nodiscard]] std::vector<std::byte> function_fs_strings(bool with_dfu);

}  // namespace tactree::hal::linux_usb
