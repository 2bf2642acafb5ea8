#pragma once
// The boards that can be emulated, and how.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tactree::emulation {

struct BoardDescription {
  const char* name;       ///< of the board and its image: <name>.elf
  const char* core;       ///< for people
  const char* toolchain;  ///< the preset that builds its image
  const char* emulator;   ///< the program
  const char* package;    ///< Debian's, that has the emulator
  const char* machine;    ///< arguments that choose the machine
  std::uint32_t blob_address;
  std::uint32_t blob_bytes_max;
  /// An instruction takes 2^shift ns of the board's time: about as long as on the real core.
  std::uint32_t instruction_shift;
  /// Can an application talk to it, on a serial port?
  bool serves;
};

[[nodiscard]] std::span<const BoardDescription> boards();
/// nullptr: no board has this name.
[[nodiscard]] const BoardDescription* find_board(std::string_view name);

}  // namespace tactree::emulation
