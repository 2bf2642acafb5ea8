#pragma once
// Calls to the emulator or debugger that the program runs under (Arm, "Semihosting for AArch32 and
// AArch64"; the RISC-V specification takes over its numbers). Without one, a call is a fault.

#include <cstdint>
#include <span>

namespace tactree::firmware::semihosting {

enum class Access : std::uint32_t { kRead = 1, kWrite = 5 };  // "rb", "wb"

/// A file of the host; -1: it cannot be opened.
[[nodiscard]] int open(std::span<const char> zero_terminated_name, Access access);
/// Waits until `bytes` are full. False: the stream has ended.
[[nodiscard]] bool read(int file, std::span<std::byte> bytes);
[[nodiscard]] bool write(int file, std::span<const std::byte> bytes);
/// Onto the console.
void print(const char* text);
/// Ends the emulation.
[[noreturn]] void exit(std::uint32_t code);

}  // namespace tactree::firmware::semihosting
