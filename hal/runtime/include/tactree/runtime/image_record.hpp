#pragma once
// The record of a firmware outside Tactree's tree, stored in its image: its name, clock, and room
// for the blob. `tactree image` and `tactree build --for` read it; seal-image adds the checksum of
// the program, which test_program() compares at the start. The firmware defines it once:
//
//   extern "C" const tactree::runtime::ImageRecord tactree_image =
//       tactree::runtime::image_record("hc3", {.clock_hz = 168'000'000,
//                                              .blob_at = 0x08020000,
//                                              .blob_room = 896 << 10,
//                                              .uf2_family = 0x57755A57});
//
// It may be anywhere in the program: no section of its own, no symbol of a linker script.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>

namespace tactree::runtime {

/// Bytes of the program where it is stored, in flash.
struct ByteRange {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
  bool operator==(const ByteRange&) const = default;
};

inline constexpr char kImageMark[8] = "TACTOWN";
inline constexpr std::uint32_t kMaxRanges = 6;

struct ImageRecord {
  char mark[8];
  char board[24];            ///< zero-terminated
  std::uint32_t clock_hz;    ///< of the processor, for the admission of models
  std::uint32_t blob_at;     ///< a multiple of 4
  std::uint32_t blob_room;   ///< bytes that only the blob uses; 0: `tactree image --room` states it
  std::uint32_t uf2_family;  ///< ID of the chip in UF2 files; 0: none
  // Written by seal-image.
  std::uint32_t count;           ///< number of ranges; 0: not sealed
  ByteRange ranges[kMaxRanges];  ///< of the program, in ascending order
  std::uint32_t checksum_at;     ///< address of `checksum`
  std::uint32_t checksum;        ///< CRC-32 of the ranges without these four bytes
};
static_assert(sizeof(ImageRecord) == 108);
static_assert(offsetof(ImageRecord, checksum) == 104);

struct ImageFacts {
  std::uint32_t clock_hz = 0;
  std::uint32_t blob_at = 0;
  std::uint32_t blob_room = 0;
  std::uint32_t uf2_family = 0;
};

/// `board`: at most 23 characters; a longer name is cut.
[[nodiscard]] constexpr ImageRecord image_record(const char* board, const ImageFacts& facts) {
  ImageRecord record{};
  for (std::size_t i = 0; i < sizeof record.mark; ++i) {  // bound: 8
    record.mark[i] = kImageMark[i];
  }
  for (std::size_t i = 0; i + 1 < sizeof record.board && board[i] != '\0'; ++i) {  // bound: 23
    record.board[i] = board[i];
  }
  record.clock_hz = facts.clock_hz;
  record.blob_at = facts.blob_at;
  record.blob_room = facts.blob_room;
  record.uf2_family = facts.uf2_family;
  return record;
}

}  // namespace tactree::runtime
