#pragma once
// A board outside this tree, described in a JSON file, which `--board FILE.json` names:
//
//   {"name": "hc3",
//    "timing": {"clock_hz": 168000000, "fetch_wait": 5, "line_bytes": 16, "cache_lines": 64,
//               "prefetches": true, "ram_wait": 1, "data_wait": 5, "ram_code_end": "0x1C000",
//               "is_estimate": true, "source": "ST RM0090, table 10"},
//    "blob": {"at": "0x08020000", "room": "896K"},
//    "uf2_family": "0x57755A57"}
//
// All keys but the name may be missing; docs/PORTING.md describes them.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "image/firmware_image.hpp"
#include "tactree/wcet/bound.hpp"

namespace tactree::cli {

struct OwnBoard {
  std::string name;
  std::optional<wcet::BoardTiming> timing;
  std::optional<BlobPlace> blob;
  std::uint32_t uf2_family = 0;  ///< 0: not stated
};

/// What --board FILE.json states for an image that does not; nothing for a name.
[[nodiscard]] Unstated unstated_by(const std::string& board);

/// True if the value of --board names a file, not a board of this tree.
[[nodiscard]] bool is_board_file(const std::string& board);

/// Throws UserError with file, key, cause and hint.
[[nodiscard]] OwnBoard read_board_file(const std::filesystem::path& file);

/// The timing of a board by its name or file. Throws UserError if it is unknown.
[[nodiscard]] wcet::BoardTiming timing_of(const std::string& board);

/// Parses 0x08020000, 917504, 896K or 1M; K and M are powers of 1024. `what` begins the message of
/// the UserError.
[[nodiscard]] std::uint32_t number_of(const std::string& what, const std::string& text);

}  // namespace tactree::cli
