#pragma once
// What the linker script knows of an image, and the part of the start-up that all cores share.

#include <cstddef>
#include <cstdint>

extern "C" {
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
extern const std::byte image_text_begin[];
extern const std::byte code_begin[];
extern const std::byte code_end[];
extern const std::byte blob_begin[];
extern const std::byte blob_end[];
extern const std::byte uf2_family[];
}

namespace tactree::firmware {

/// Did the memory of all variables hold what was written, before anything was in it? The stack is
/// in use meanwhile, and not tested.
[[nodiscard]] bool variables_hold();

/// Tests the memory of the variables, copies .data, clears .bss, runs the constructors, and main().
/// No float may be touched before the FPU is on, and no static object before this.
[[noreturn]] void start_image();

}  // namespace tactree::firmware
