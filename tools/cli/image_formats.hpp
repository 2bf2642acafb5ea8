#pragma once
// What programmers and boot loaders read.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware_image.hpp"

namespace tactree::cli {

/// What `to_bin` gives may have this many bytes: gaps in it are filled.
inline constexpr std::uint64_t kLargestBin = 64U << 20;

/// From the first byte to the last, gaps as erased flash: 0xFF. Precondition: segments by address,
/// none overlapping another, end - begin <= kLargestBin.
[[nodiscard]] std::vector<std::byte> to_bin(std::span<const Segment> segments);

/// Intel HEX, with 32-bit addresses and the entry.
[[nodiscard]] std::vector<std::byte> to_hex(std::span<const Segment> segments, std::uint32_t entry);

/// UF2 (github.com/microsoft/uf2), blocks of 256 bytes on addresses that divide by it; what the
/// segments leave open in a block is 0xFF.
[[nodiscard]] std::vector<std::byte> to_uf2(std::span<const Segment> segments,
                                            std::uint32_t family);

/// to_bin() with the suffix of USB DFU 1.1, appendix B. 0xFFFF: any vendor, any product.
[[nodiscard]] std::vector<std::byte> to_dfu(std::span<const Segment> segments, std::uint16_t vendor,
                                            std::uint16_t product);

/// The firmware's own ELF file with its symbols, and `blob` as a further segment and section.
[[nodiscard]] std::vector<std::byte> to_elf(std::span<const std::byte> file, const Segment& blob);

}  // namespace tactree::cli
