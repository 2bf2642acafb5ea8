#pragma once
// Boards with firmware in this repository, and how they are emulated.

#include <cstdint>
#include <span>
#include <string_view>

namespace tactree::emulation {

struct BoardDescription {
  const char* name;       ///< of the board and its image: <name>.elf
  const char* core;       ///< for messages
  const char* toolchain;  ///< the preset that builds its image
  const char* emulator;   ///< name of the program in PATH; nullptr if none emulates the board
  const char* package;    ///< Debian package of the emulator
  const char* machine;    ///< arguments of the emulator that select the machine
  std::uint32_t blob_address;
  std::uint32_t blob_bytes_max;  ///< of the model in the image, or of a slot of the model store
  /// An instruction takes 2^shift ns of the board's time, about as long as on the real core.
  std::uint32_t instruction_shift;
  /// True if applications can connect to its serial port.
  bool serves;

  [[nodiscard]] bool is_emulated() const { return emulator != nullptr; }
};

[[nodiscard]] std::span<const BoardDescription> boards();
/// Returns nullptr if no board has this name.
[[nodiscard]] const BoardDescription* find_board(std::string_view name);

}  // namespace tactree::emulation
