#pragma once
// Calls to the emulator or debugger (Arm, "Semihosting for AArch32 and AArch64"; the RISC-V
// specification uses the same numbers). Without an emulator or debugger a call causes a fault.

#include <cstdint>
#include <span>

namespace tactree::firmware::semihosting {

enum class Access : std::uint32_t { kRead = 1, kWrite = 5 };  // "rb", "wb"

/// Opens a file of the host. Returns -1 on failure.
[[nodiscard]] int open(std::span<const char> zero_terminated_name, Access access);
/// Blocks until `bytes` is full. Returns false if the stream has ended.
[[nodiscard]] bool read(int file, std::span<std::byte> bytes);
[[nodiscard]] bool write(int file, std::span<const std::byte> bytes);
/// Prints to the console.
void print(const char* text);
/// Ends the emulation.
[[noreturn]] void exit(std::uint32_t code);

}  // namespace tactree::firmware::semihosting
