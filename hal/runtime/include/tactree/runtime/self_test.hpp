#pragma once
// The self-test of the program at the start of a firmware outside Tactree's tree: its bytes in
// flash, compared with the checksum that seal-image wrote into its record (image_record.hpp). The
// test of RAM is in memory_test.hpp. Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/math/crc32.hpp"
#include "tactree/hal/start_result.hpp"
#include "tactree/runtime/image_record.hpp"

/// The record of this firmware, which defines it.
extern "C" [[gnu::weak]] const tactree::runtime::ImageRecord tactree_image;

namespace tactree::runtime {

/// CRC-32 of the ranges of a sealed record. `bytes_at(address, bytes)` returns the bytes there.
/// Cost: about 10 instructions per byte.
template <class BytesAt>
[[nodiscard]] std::uint32_t checksum_of(const ImageRecord& record, BytesAt bytes_at) {
  core::Crc32 checksum;
  for (std::uint32_t i = 0; i < record.count; ++i) {  // bound: kMaxRanges
    const ByteRange& range = record.ranges[i];
    const std::span<const std::byte> bytes = bytes_at(range.address, range.bytes);
    const std::uint32_t before = record.checksum_at - range.address;  // wraps if it is below
    if (before >= range.bytes) {
      checksum.update(bytes);
      continue;
    }
    checksum.update(bytes.first(before));
    checksum.update(bytes.subspan(before + sizeof record.checksum));
  }
  return checksum.value();
}

/// True if the record is sealed and its ranges have its checksum.
template <class BytesAt>
[[nodiscard]] bool holds_program(const ImageRecord& record, BytesAt bytes_at) {
  return record.count > 0U && record.count <= kMaxRanges &&
         checksum_of(record, bytes_at) == record.checksum;
}

/// Tests the program. kDamaged also if the image has no record or was not sealed. Call it before
/// the controller starts, and do not start it after a failure.
[[nodiscard]] hal::ImageStatus test_program();

}  // namespace tactree::runtime
