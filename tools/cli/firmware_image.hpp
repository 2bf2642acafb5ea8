#pragma once
// A firmware image as the linker left it: an ELF file with an identity
// (firmware/runtime/identity.hpp).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tactree::cli {

/// Bytes that belong at an address.
struct Segment {
  std::uint32_t address = 0;
  std::vector<std::byte> bytes;
};

struct FirmwareImage {
  std::string board;
  std::uint32_t code_begin = 0;  ///< room for the code
  std::uint32_t code_end = 0;
  std::uint32_t blob_begin = 0;  ///< room for the blob
  std::uint32_t blob_end = 0;
  std::uint32_t uf2_family = 0;  ///< 0: none
  std::uint32_t entry = 0;
  std::vector<Segment> segments;  ///< by address
  std::vector<std::byte> file;    ///< the ELF file itself
};

/// Reads and checks: a whole 32-bit little-endian ELF program, one identity, every byte of it in
/// the room for code, the checksum right. Throws CommandError that names the file, the cause and
/// the remedy.
[[nodiscard]] FirmwareImage read_firmware(const std::filesystem::path& file);

}  // namespace tactree::cli
