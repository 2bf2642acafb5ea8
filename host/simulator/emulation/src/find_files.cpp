#include "find_files.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <vector>

#include "tactree/emulation/emulated_target.hpp"

namespace tactree::emulation {
namespace {

namespace fs = std::filesystem;

constexpr char kCounter[] = "tactree_instruction_counter.so";

/// A folder of the installation that contains this program; empty if /proc is not available.
fs::path installed(const fs::path& folder) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : program.parent_path().parent_path() / folder;
}

fs::path first_existing(const std::vector<fs::path>& candidates) {
  std::error_code error;
  for (const fs::path& candidate : candidates) {
    if (fs::is_regular_file(candidate, error)) {
      return fs::absolute(candidate, error);
    }
  }
  return {};
}

}  // namespace

fs::path find_counter() {
  const fs::path found = first_existing(
      {installed(TACTREE_LIBRARY_FOLDER) / kCounter, fs::path(TACTREE_COUNTER_BUILT) / kCounter});
  if (found.empty()) {
    throw EmulationError(fmt::format("{} is missing (install or build Tactree again)", kCounter));
  }
  return found;
}

std::string how_to_build(const BoardDescription& board) {
  return fmt::format(
      "scripts/install-deps firmware && cmake --preset {0} && cmake --build --preset {0}",
      board.toolchain);
}

fs::path find_image(const BoardDescription& board, const fs::path& folder) {
  const std::string file = std::string(board.name) + ".elf";
  const char* named = std::getenv("TACTREE_FIRMWARE");
  const fs::path built = fs::path(TACTREE_FIRMWARE_BUILT) / board.toolchain / "firmware";
  fs::path found;
  if (!folder.empty()) {
    found = first_existing({folder / file});
  } else if (named != nullptr) {
    found = first_existing({fs::path(named) / file});
  } else {
    found = first_existing({installed("lib/tactree/firmware") / file, built / file});
  }
  if (!found.empty()) {
    return found;
  }
  const std::string where = !folder.empty() ? folder.string() : named != nullptr ? named : "";
  throw EmulationError(fmt::format("board {}: there is no image {}{}{} (build it: {})", board.name,
                                   file, where.empty() ? "" : " in ", where, how_to_build(board)));
}

}  // namespace tactree::emulation
