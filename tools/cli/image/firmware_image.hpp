#pragma once
// A firmware image: an ELF file with an identity (firmware/runtime/identity.hpp).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tactree::cli {

/// Bytes at an address.
struct Segment {
  std::uint32_t address = 0;
  std::vector<std::byte> bytes;
};

struct FirmwareImage {
  std::string board;
  std::uint32_t code_begin = 0;  ///< range reserved for code
  std::uint32_t code_end = 0;
  std::uint32_t blob_begin = 0;  ///< range reserved for the blob
  std::uint32_t blob_end = 0;
  std::uint32_t uf2_family = 0;  ///< 0: none
  std::uint32_t entry = 0;
  std::vector<Segment> segments;  ///< sorted by address
  std::vector<std::byte> file;    ///< the ELF file itself
};

/// Reads and checks a file. It must be a complete 32-bit little-endian ELF program with one
/// identity, all bytes in the range for code, and a valid checksum. Throws UserError with file,
/// cause and hint.
[[nodiscard]] FirmwareImage read_firmware(const std::filesystem::path& file);

}  // namespace tactree::cli
