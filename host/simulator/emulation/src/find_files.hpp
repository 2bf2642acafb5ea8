#pragma once
// Finds the files that an emulation needs, installed or in the build tree.

#include <filesystem>
#include <string>

#include "tactree/emulation/board_description.hpp"

namespace tactree::emulation {

/// Path of the instruction counter, a plugin of the emulator. Throws EmulationError if it is
/// missing.
[[nodiscard]] std::filesystem::path find_counter();

/// Commands that build the board's image, for messages.
[[nodiscard]] std::string how_to_build(const BoardDescription& board);

}  // namespace tactree::emulation
