#pragma once
// Symbols of the linker script, and the start-up common to all cores.

#include <cstddef>
#include <cstdint>

extern "C" {
// NOLINTBEGIN(readability-identifier-naming): names of the linker script
extern std::uint32_t image_data_begin[];
extern std::uint32_t image_data_end[];
extern const std::uint32_t image_data_source[];
extern std::uint32_t image_bss_begin[];
extern std::uint32_t image_bss_end[];
extern std::uint32_t image_tested_begin[];
extern std::uint32_t image_tested_end[];
extern std::uint32_t image_stack_bottom[];
extern std::uint32_t image_stack_top[];
extern void (*const image_constructors_begin[])();
extern void (*const image_constructors_end[])();

extern const std::byte image_vectors_begin[];
extern const std::byte image_vectors_end[];
extern const std::byte image_slow_begin[];
extern const std::byte image_slow_end[];
extern const std::byte image_text_begin[];
extern const std::byte code_begin[];
extern const std::byte code_end[];
extern const std::byte blob_begin[];
extern const std::byte blob_end[];
extern const std::byte uf2_family[];
// NOLINTEND(readability-identifier-naming)
}

namespace tactree::firmware {

/// Result of the RAM test of all variables, which runs before they are initialised. The stack is in
/// use during the test and is not tested.
[[nodiscard]] bool variables_hold();

/// Tests the memory of the variables, copies .data, clears .bss, runs the constructors and main().
/// Preconditions: the FPU is enabled, and no static object has been used.
[[noreturn]] void start_image();

}  // namespace tactree::firmware
