#pragma once
// A firmware image: an ELF file with an identity (firmware/runtime/identity.hpp), with the record
// of a firmware outside this tree (tactree/runtime/image_record.hpp), or with neither.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tactree::cli {

/// Bytes at an address.
struct Segment {
  std::uint32_t address = 0;
  std::vector<std::byte> bytes;
};

/// Room for the blob.
struct BlobPlace {
  std::uint32_t address = 0;
  std::uint32_t room = 0;  ///< bytes
};

/// What an image without identity or record does not state.
struct Unstated {
  std::string board;  ///< empty: the name of the file
  std::optional<BlobPlace> place;
};

struct FirmwareImage {
  std::string board;
  bool states_room = false;      ///< false: blob_begin and blob_end are those of Unstated
  std::uint32_t clock_hz = 0;    ///< of the ticks; 0: the image does not state it
  std::uint32_t code_begin = 0;  ///< range reserved for code
  std::uint32_t code_end = 0;
  std::uint32_t blob_begin = 0;  ///< range reserved for the blob
  std::uint32_t blob_end = 0;
  std::uint32_t uf2_family = 0;  ///< 0: none
  std::uint32_t entry = 0;
  std::vector<Segment> segments;  ///< sorted by address
  std::vector<std::byte> file;    ///< the ELF file itself
};

/// Reads and checks a file: a complete 32-bit little-endian ELF program. One with an identity has
/// all bytes in its range for code, and a valid checksum. Any other is a firmware outside this
/// tree: its bytes must not reach into the room of the blob, which its sealed record or `unstated`
/// states. Throws UserError with file, cause and hint.
[[nodiscard]] FirmwareImage read_firmware(const std::filesystem::path& file,
                                          const Unstated& unstated = {});

}  // namespace tactree::cli
