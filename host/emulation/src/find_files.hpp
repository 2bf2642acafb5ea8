#pragma once
// Where the files that an emulation needs are: installed, or in the build tree.

#include <filesystem>
#include <string>

#include "tactree/emulation/board_description.hpp"

namespace tactree::emulation {

/// The instruction counter, a plugin of the emulator. Throws EmulationError when it is nowhere.
[[nodiscard]] std::filesystem::path find_counter();

/// For the remedy in an error.
[[nodiscard]] std::string how_to_build(const BoardDescription& board);

}  // namespace tactree::emulation
