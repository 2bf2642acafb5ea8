#pragma once
// The device's descriptors in the form that FunctionFS wants them.

#include <cstddef>
#include <vector>

namespace tactree::hal::linux_usb {

/// Of both speeds; with the DFU interfaces or without.
[[nodiscard]] std::vector<std::byte> function_fs_descriptors(bool with_dfu);
/// Names of the interfaces.
[[nodiscard]] std::vector<std::byte> function_fs_strings(bool with_dfu);

}  // namespace tactree::hal::linux_usb
