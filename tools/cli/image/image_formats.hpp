#pragma once
// Encoders of the file formats of programmers and boot loaders.

#include <cstdint>
#include <span>
#include <vector>

#include "image/firmware_image.hpp"

namespace tactree::cli {

/// Maximum result of to_bin(), bytes. Needs a limit because to_bin() fills gaps.
inline constexpr std::uint64_t kMaxBinBytes = 64U << 20;

/// The bytes from the first to the last segment; gaps are 0xFF, like erased flash. Precondition:
/// the segments are sorted by address and do not overlap, and end - begin <= kMaxBinBytes.
[[nodiscard]] std::vector<std::byte> to_bin(std::span<const Segment> segments);

/// Intel HEX with 32-bit addresses and the entry point.
[[nodiscard]] std::vector<std::byte> to_hex(std::span<const Segment> segments, std::uint32_t entry);

/// UF2 (github.com/microsoft/uf2): blocks of 256 bytes at multiples of 256; bytes of a block
/// outside the segments are 0xFF.
[[nodiscard]] std::vector<std::byte> to_uf2(std::span<const Segment> segments,
                                            std::uint32_t family);

/// to_bin() with the suffix of USB DFU 1.1, appendix B. 0xFFFF: any vendor, any product.
[[nodiscard]] std::vector<std::byte> to_dfu(std::span<const Segment> segments, std::uint16_t vendor,
                                            std::uint16_t product);

/// The ELF file of the firmware with its symbols, and `blob` as an additional segment and section.
[[nodiscard]] std::vector<std::byte> to_elf(std::span<const std::byte> file, const Segment& blob);

}  // namespace tactree::cli
